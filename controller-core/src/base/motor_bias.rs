//! How much stronger one motor is than the other, found while the base drives.

use crate::range::clamp;
use crate::scalar::Scalar;

/// ± 10 %: brushed motors of one lot differ by 5 to 10 %, so each is off the mean of both by 5 % at most. As much again for magnets that
/// age, and for a file that has one motor for two kinds.
const MOST: f64 = 0.1;
/// G: a wheel that is held back is made up for a part of its back-EMF that is missing, 1/(1 + ωτ/4) of it
/// ([`Odometry::back_emf_speeds`](crate::odometry::Odometry::back_emf_speeds)). Least squares of what is missing have that as their gain: 1.3 on the 10 kg base, where
/// a turn of the free wheels settles in τ = 20 ms, 4.5 on the 30 kg base with its 0.28 s. With more than that the past counts less.
const GAIN: f64 = 4.0;
/// T₀ \[s\]: what is believed beforehand, that both are alike, weighs as much as so long a drive at the present speed. The share then
/// goes to its value with G/T₀/(1 + ωτ/4) at most, 3.1/s and 0.9/s on these bases: a fifth of the rates at which odometry there learns what holds a
/// wheel back, 17/s and 4.5/s.
const BELIEF_S: f64 = 1.0;
/// v₀ \[m/s\]: below it friction, which is not of the motors, says more. At 0.1 m/s 3 % of the back-EMF of the three example bases' motors are a fourth, a fourth and a
/// tenth of their wheels' Coulomb friction (30, 10 and 1 kg).
const SLOW_M_S: f64 = 0.1;
/// T \[s\]: what was seen is forgotten in so long a time, driving or at rest: copper and magnets get warm within minutes.
const MEMORY_S: f64 = 10.0;

/// By what share the motor constant of the right wheel is above what is stated, and that of the left one below it.
///
/// One motor is described for both wheels, and no two are alike. A constant that is 3 % above it makes a back-EMF that is so much larger
/// than the voltage that is to make up for it, and the wheel is held back in proportion to its speed: 0.6 N m at each wheel of the 10 kg base at 1.1 m/s, one forward,
/// the other backward. Odometry learns for each wheel what holds it back, and the winding makes up for a part of that at once, but anew
/// at each change of the speed. The share is what stays:
///
/// ```text
/// δ ← δ + dt G v e/(S + T₀ (v² + v₀²))      S ← S + dt (v² − S/T)      |δ| ≤ δ_max
/// ```
///
/// | symbol | what | unit |
/// | --- | --- | --- |
/// | δ | the share | |
/// | e | half of what the winding makes up at the right wheel beyond the left one | m/s |
/// | v | speed of the base | m/s |
/// | S | what was seen until now | m²/s |
///
/// the least squares of e = (missing share) v. It ends where both wheels are held back alike. A slope holds both back alike, and tells nothing;
/// one wheel that rubs more than the other looks like a motor, and is made up for in the same way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MotorBias<T> {
    pub(super) share: T,
    seen: T,
}

impl<T: Scalar> MotorBias<T> {
    /// Takes a tick of `dt` \[s\] at the `speed` \[m/s\], in which the right wheel was made up by `beyond` \[m/s\] beyond the mean of both.
    pub(super) fn advance(&mut self, speed: T, beyond: T, dt: T) {
        let f = T::from_f64;
        let square = speed * speed;
        self.seen += dt * (square - f(1.0 / MEMORY_S) * self.seen);
        let weight = self.seen + f(BELIEF_S) * (square + f(SLOW_M_S * SLOW_M_S));
        let share = self.share + dt * (f(GAIN) * (speed * beyond)) / weight;
        self.share = clamp(share, f(MOST));
    }
}

#[cfg(test)]
mod tests {
    use super::{MEMORY_S, MOST, MotorBias};

    /// A base whose right motor is stronger by `share` and whose free wheels settle in `tau` \[s\] as it turns, driven at these speeds for a
    /// second each: what is learnt after each of them. Odometry (50 rad/s) knows what holds a wheel back at once.
    fn learnt<const N: usize>(share: f64, tau: f64, speeds: [f64; N]) -> [f64; N] {
        let mut bias = MotorBias::default();
        speeds.map(|speed| {
            for _ in 0..100 {
                let part = 1.0 / (1.0 + 50.0 * tau / 4.0);
                let beyond = part * (share - bias.share) * speed;
                bias.advance(speed, beyond, 0.01);
            }
            bias.share
        })
    }

    /// Within a fifth after a second at any speed that is not slow, forward or backward, on motors that hold a base much; then it stays.
    #[test]
    fn a_stronger_motor_is_learnt() {
        for share in [0.03, -0.05] {
            for speed in [0.3, -1.0, 2.5] {
                let found = learnt(share, 0.02, [speed, 0.0, speed, speed]);
                assert!((found[0] / share - 1.0).abs() < 0.2, "{speed}: {found:?}");
                assert_eq!(found[0], found[1]);
                assert!((found[3] / share - 1.0).abs() < 0.02, "{speed}: {found:?}");
            }
            // A body that is hard to turn: half after a second, and never beyond.
            let found = learnt(share, 0.28, [1.0; 20]);
            assert!(
                found[0] / share > 0.4 && found[19] / share > 0.9,
                "{found:?}"
            );
            assert!(found.iter().all(|found| found / share <= 1.0), "{found:?}");
        }
    }

    /// A motor that gets warm: what was seen fades in 10 s, driving or at rest, so that half of the change is learnt within 3 s of
    /// driving even after a day.
    #[test]
    fn what_changes_is_learnt_anew() {
        let mut bias = MotorBias::<f64>::default();
        let mut drive = |share: f64, seconds: u32| {
            for _ in 0..100 * seconds {
                bias.advance(1.0, share - bias.share, 0.01);
            }
            bias
        };
        let cold = drive(0.03, 86_400);
        // S → v² T.
        assert!((cold.seen - MEMORY_S).abs() < 1e-6, "{cold:?}");
        assert!((cold.share - 0.03).abs() < 1e-6, "{cold:?}");
        let warm = drive(-0.03, 3);
        assert!(warm.share < 0.0 && warm.share > -0.03, "{warm:?}");
        let mut rested = warm;
        for _ in 0..1000 {
            rested.advance(0.0, 0.0, 0.01);
        }
        assert_eq!(rested.share, warm.share);
        let left = (-10.0 / MEMORY_S).exp();
        assert!((rested.seen / warm.seen - left).abs() < 1e-3, "{rested:?}");
    }

    /// At rest nothing, creeping little; never more than motors differ.
    #[test]
    fn what_is_no_motor_is_not_learnt() {
        assert_eq!(learnt(0.03, 0.02, [0.0]), [0.0]);
        let mut bias = MotorBias::<f64>::default();
        // A wheel that rubs: a made-up difference that does not fall with the speed.
        for _ in 0..100 {
            bias.advance(0.01, 1.0e-3, 0.01);
        }
        assert!(bias.share > 0.0 && bias.share < 0.01, "{bias:?}");
        for _ in 0..1000 {
            bias.advance(1.0, 1.0, 0.01);
        }
        assert_eq!(bias.share, MOST);
    }
}
