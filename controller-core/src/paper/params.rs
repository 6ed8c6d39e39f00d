//! Parameters of the paper's law: plain data, validated once into a type that cannot be wrong.

use crate::cast::cast;
use crate::error::{Field, ParamError};
use crate::range::within;
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::shunting::{NeuronParams, Shunting};
use crate::wheels::WheelMap;

/// Gains of tracking, Eqs. (10)-(12) and (15)-(16). Each 1e-6 to 1e6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackingGains<T> {
    /// k₁ \[1/s\]: along the path.
    pub k1: T,
    /// k₂ \[1/m²\]: across the path, times v_r.
    pub k2: T,
    /// k₃ \[rad/s\]: heading.
    pub k3: T,
    /// k_d1 \[N s/m\]: speed loop.
    pub k_d1: T,
    /// k_d2 \[N m s\]: turn-rate loop.
    pub k_d2: T,
}

cast!(TrackingGains {
    k1,
    k2,
    k3,
    k_d1,
    k_d2
});

/// Gains of parking, Eqs. (13)-(14) and (20)-(21). Each 1e-6 to 1e6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParkingGains<T> {
    /// k₄ \[1/s\]: along the heading.
    pub k4: T,
    /// k₅ \[rad/s\]: heading.
    pub k5: T,
    /// k_c1 \[N s/m\]: speed loop.
    pub k_c1: T,
    /// k_c2 \[N m s\]: turn-rate loop.
    pub k_c2: T,
}

cast!(ParkingGains { k4, k5, k_c1, k_c2 });

/// What happens to the acceleration neurons at the hand-over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Reset {
    /// They take the values with which the torque does not jump, whatever the gains.
    #[default]
    TorqueContinuous,
    /// v̇_s(P) = v̇_c(P−1), ẇ_s(P) = ẇ_c(P−1), as the paper prints it. The torque jumps; see
    /// `docs/errata.md`.
    Printed,
    /// They start from zero. The torque jumps.
    Zero,
}

/// Everything that the paper's controller needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params<T> {
    /// The base.
    pub robot: Robot<T>,
    /// Gains while tracking.
    pub tracking: TrackingGains<T>,
    /// Gains while parking.
    pub parking: ParkingGains<T>,
    /// All neurons share these.
    pub neurons: NeuronParams<T>,
    /// What happens to the acceleration neurons at the hand-over.
    pub reset: Reset,
    /// Largest torque of either wheel \[N m\], 1e-6 to 1e6; `None` leaves torques unlimited.
    pub max_wheel_torque_nm: Option<T>,
    /// Longest accepted time between ticks \[s\], 1e-6 to 1e3.
    pub max_tick_s: T,
}

impl<T: Scalar> Params<T> {
    /// The paper's robot with the gains of this project, called G in `docs/derivation.md`.
    ///
    /// The paper gives no gain. G was fitted to its two stated settling times (5.0 s and 5.2 s);
    /// k_d = (3 m, 5 I). A = B = D makes the slow gain of each neuron 1, so that k₁..k₅ keep their
    /// meaning in (10) and (13).
    pub fn paper() -> Self {
        let f = T::from_f64;
        Self {
            robot: Robot::paper(),
            tracking: TrackingGains {
                k1: f(0.9),
                k2: f(6.0),
                k3: f(2.0),
                k_d1: f(90.0),
                k_d2: f(75.0),
            },
            parking: ParkingGains {
                k4: f(1.2),
                k5: f(1.2),
                k_c1: f(90.0),
                k_c2: f(75.0),
            },
            neurons: NeuronParams {
                a: f(4.0),
                b: f(4.0),
                d: f(4.0),
            },
            reset: Reset::TorqueContinuous,
            max_wheel_torque_nm: None,
            max_tick_s: f(0.5),
        }
    }

    /// The same in another precision: each number is rounded to nearest, and exact where it widens.
    pub fn cast<S: Scalar>(&self) -> Params<S> {
        Params {
            robot: self.robot.cast(),
            tracking: self.tracking.cast(),
            parking: self.parking.cast(),
            neurons: self.neurons.cast(),
            reset: self.reset,
            max_wheel_torque_nm: self.max_wheel_torque_nm.map(T::cast),
            max_tick_s: self.max_tick_s.cast(),
        }
    }

    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range, with the limit it passed.
    pub fn validate(self) -> Result<ValidParams<T>, ParamError> {
        const GAIN: (f64, f64) = (1.0e-6, 1.0e6);
        let robot = &self.robot;
        robot.check()?;
        let wheels = WheelMap::from_geometry(&robot.wheels)?;
        for (field, gain) in [
            (Field::K1, self.tracking.k1),
            (Field::K2, self.tracking.k2),
            (Field::K3, self.tracking.k3),
            (Field::Kd1, self.tracking.k_d1),
            (Field::Kd2, self.tracking.k_d2),
            (Field::K4, self.parking.k4),
            (Field::K5, self.parking.k5),
            (Field::Kc1, self.parking.k_c1),
            (Field::Kc2, self.parking.k_c2),
        ] {
            within(field, gain, GAIN.0, GAIN.1)?;
        }
        let shunting = Shunting::new(&self.neurons)?;
        let torque_limit = match self.max_wheel_torque_nm {
            Some(limit) => within(Field::MaxWheelTorque, limit, 1.0e-6, 1.0e6)?,
            None => T::MAX,
        };
        within(Field::MaxTick, self.max_tick_s, 1.0e-6, 1.0e3)?;
        Ok(ValidParams {
            params: self,
            shunting,
            wheels,
            torque_limit,
        })
    }
}

/// [`Params`] that passed `validate`, with what follows from them worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidParams<T> {
    pub(crate) params: Params<T>,
    pub(crate) shunting: Shunting<T>,
    pub(crate) wheels: WheelMap<T>,
    pub(crate) torque_limit: T,
}

impl<T: Scalar> ValidParams<T> {
    /// The parameters as they were given.
    pub fn params(&self) -> &Params<T> {
        &self.params
    }

    /// The neurons' equation.
    pub fn shunting(&self) -> &Shunting<T> {
        &self.shunting
    }

    /// The map between wrench and wheel torques.
    pub fn wheels(&self) -> &WheelMap<T> {
        &self.wheels
    }
}
