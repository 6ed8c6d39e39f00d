//! What tyres lose of what their wheels turn.
//!
//! A tyre transmits a force only where it slips: as long as it grips, its rim turns faster than it rolls by the share F/(C N) of the
//! force F and the load N, and pushed aside by F it moves aside by that share of its speed (the linear part of every model of tyres; C is
//! some 10 to 30 for rubber, and more for hard wheels). Forces accelerate the base, so that of one number κ = 1/(C g) \[s²/m\],
//! larger where a caster takes some of the load, follows all that odometry has to take off. Bodies that are hard to turn push their tyres
//! hard: with I = 15 kg m² on 30 kg and 0.5 m a turn that begins at 1 m/s loses 50 mrad per rad/s at C = 16, until it ends.

use crate::range::larger;
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::types::{Accel, Twist};

/// Delay of a velocity loop that a slip which is believed too large may cost \[rad\], as a share of the loop's time constant: a fifth, 29 ms of 7 rad/s. Loops stand
/// 50 ms and more ([`MotionDesignSpec`](crate::tuning::motion::MotionDesignSpec)).
const LATE: f64 = 0.2;

/// What has to be known of a robot to take off what its tyres lose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tyres<T> {
    /// 4I/(m l²), [`Robot::turning_load`].
    turning_load: T,
    /// The largest κ |v| that is taken off a twist \[s\].
    pub(crate) most_s: T,
}

impl<T: Scalar> Tyres<T> {
    /// Of a robot that nothing is known of: rigid ones.
    pub(crate) const RIGID: Self = Self {
        turning_load: T::ZERO,
        most_s: T::ZERO,
    };

    /// Of a robot whose torques follow its twist with this bandwidth \[rad/s\].
    ///
    /// What a twist loses follows the torques at once, and they follow the twist. Where κ is believed too large, on a hard floor after a
    /// soft one, that is as if the twist came κ |v| and, of a turn, 4I/(m l²) times that too late: at 2.5 m/s and 8 up to 0.2 s, in which a
    /// loop of 7 rad/s swings. So no more is taken off than is [`LATE`] in that loop.
    pub(crate) fn new(robot: &Robot<T>, bandwidth: T) -> Self {
        let turning_load = robot.turning_load();
        Self {
            turning_load,
            most_s: T::from_f64(LATE) / (bandwidth * larger(T::ONE, turning_load)),
        }
    }

    /// What they have to transmit, as shares of way and turn that they lose where κ is 1 s²/m: (a, 4I/(m l²) α) \[m/s²\], \[rad/s²\].
    ///
    /// Each rim pushes with ½ m a ± I α/l on half of the weight, and slips by κ |v| (a ± 2I α/(m l)): both alike is way that is lost, and the
    /// difference over l is turn.
    pub(crate) fn strain(&self, accel: &Accel<T>) -> Accel<T> {
        Accel {
            linear: accel.linear,
            angular: self.turning_load * accel.angular,
        }
    }
}

/// How far the direction in which a base moves is from its heading \[rad\]: −κ |v| w, for v w accelerates it aside.
pub(crate) fn drift_angle<T: Scalar>(slip: T, twist: &Twist<T>) -> T {
    -(slip * twist.linear.abs() * twist.angular)
}

#[cfg(test)]
mod tests {
    use super::{Tyres, drift_angle};
    use crate::robot::Robot;
    use crate::types::{Accel, Twist};

    /// 4 · 15 kg m²/(30 kg · (0.5 m)²) = 8: a turn strains the tyres eight times as much, and a fifth of a loop of 7 rad/s is left to it an eighth
    /// each. A body that is easy to turn takes the fifth for its way.
    #[test]
    fn what_a_turn_strains() {
        let accel = Accel::new(-0.3, 0.25);
        let heavy = Robot::<f64>::paper();
        let light = Robot {
            inertia_kg_m2: 0.9375,
            ..heavy
        };
        for (robot, load, most_s) in [(heavy, 8.0, 0.2 / 56.0), (light, 0.5, 0.2 / 7.0)] {
            let tyres = Tyres::new(&robot, 7.0);
            assert_eq!(tyres.strain(&accel), Accel::new(-0.3, 0.25 * load));
            assert!((tyres.most_s - most_s).abs() < 1e-15, "{tyres:?}");
        }
    }

    /// Away from the centre of the turn, forward and backward.
    #[test]
    fn a_base_drifts_outwards() {
        for (v, w, angle) in [(0.5, 2.0, -0.03), (-0.5, 2.0, -0.03), (0.5, -2.0, 0.03)] {
            let found: f64 = drift_angle(0.03, &Twist::new(v, w));
            assert!((found - angle).abs() < 1e-15, "{v} {w}: {found}");
        }
    }
}
