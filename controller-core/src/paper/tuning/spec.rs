//! Design specification for the paper's law.

use crate::scalar::Scalar;
use crate::tuning::error::in_range;
use crate::tuning::{DesignError, DesignParameter};

/// What an owner wants of tracking and parking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DesignSpec<T> {
    /// An offset of 0.5 m, along or across the path, is below 5 cm after this \[s\], 0.5 to 100; the
    /// distance at parking likewise.
    pub settling_s: T,
    /// Damping ratio of the lateral pair, 0.6 (10 % overshoot) to 0.98 (none).
    pub damping: T,
    /// Lag of the speed loop 1/κ₁ = m/k_d1 \[s\], 1e-3 to 10.
    pub speed_lag_s: T,
    /// Lag of the turn-rate loop 1/κ₂ = I/k_d2 \[s\], 1e-3 to 10.
    pub turn_lag_s: T,
    /// Reference speed that all this holds at \[m/s\], 1e-2 to 100. The time grows below it.
    pub speed: T,
}

/// What an owner tolerates, in place of times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance<T> {
    /// A force that the model does not know (slope, cable, friction) may move a parked robot by this
    /// much: k_c1 k₄ = force/error.
    Steady {
        /// \[N\], 1e-6 to 1e6.
        force_n: T,
        /// \[m\], 1e-6 to 10.
        error_m: T,
    },
    /// A blocked robot pushes with all that the wheels have at this distance to its goal:
    /// k_c1 k₄ = largest force/error.
    FullTorque {
        /// \[m\], 1e-6 to 100.
        error_m: T,
    },
}

/// Settling time times κ₁ and κ₂, as with the gains G.
const LOOPS: (f64, f64) = (15.0, 25.0);
impl<T: Scalar> DesignSpec<T> {
    /// One time for everything; loops as much faster than it as those of the gains G are: lags of a
    /// 15th and a 25th of it, damping 0.85.
    pub fn settling(settling_s: T, speed: T) -> Self {
        let f = T::from_f64;
        Self {
            settling_s,
            damping: f(0.85),
            speed_lag_s: settling_s / f(LOOPS.0),
            turn_lag_s: settling_s / f(LOOPS.1),
            speed,
        }
    }

    pub(super) fn check(&self) -> Result<(), DesignError> {
        for (parameter, value, low, high) in [
            (DesignParameter::Settling, self.settling_s, 0.5, 100.0),
            (DesignParameter::Damping, self.damping, 0.6, 0.98),
            (DesignParameter::SpeedLag, self.speed_lag_s, 1.0e-3, 10.0),
            (DesignParameter::TurnLag, self.turn_lag_s, 1.0e-3, 10.0),
            (DesignParameter::Speed, self.speed, 1.0e-2, 100.0),
        ] {
            in_range(parameter, value, low, high)?;
        }
        Ok(())
    }
}
