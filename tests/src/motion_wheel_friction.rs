//! Dry friction at each wheel: either of them may stand while the other slides.

use controller_core::types::{Twist, Wrench};

use crate::ideal::Robot;
use crate::motion_base::{Base, Body, HALF_TRACK, RADIUS};
use crate::motion_friction::Friction;

/// Dry friction of one wheel, as a force at its rim \[N\].
#[derive(Clone, Copy, Debug)]
pub struct WheelFriction {
    /// Breakaway.
    pub sticking: f64,
    /// While it slides.
    pub sliding: f64,
}

/// Steps within a tick: friction changes sign within one of them, not within a tick.
const STEPS: u32 = 10;

impl WheelFriction {
    /// A share of the force of a wheel to break away, four fifths of that in motion.
    pub fn of(base: &Base, share: f64) -> Self {
        let sticking = share * base.limits.wheel_torque_nm / RADIUS;
        Self {
            sticking,
            sliding: 0.8 * sticking,
        }
    }

    /// Forces of friction, right and left, over a step: each stops its wheel if it can, and otherwise
    /// is as large as it gets.
    ///
    /// With U the rim speeds at the end of the step without friction and B = [[p, q], [q, p]],
    /// p = h (1/m + b²/I), q = h (1/m − b²/I), the speeds are U + B f. Both stand for f = −U/B; if
    /// that is too much, one wheel after the other, which ends since |q| < p.
    fn forces(&self, twist: &Twist<f64>, plant: &Base, wrench: &Wrench<f64>, h: f64) -> [f64; 2] {
        let (along, around) = (h / plant.mass, h * HALF_TRACK.powi(2) / plant.inertia);
        let (p, q) = (along + around, along - around);
        let free = rims(&Twist::new(
            twist.linear + along * wrench.force,
            twist.angular + h / plant.inertia * wrench.moment,
        ));
        let bound = rims(twist).map(|rim| {
            if rim == 0.0 {
                self.sticking
            } else {
                self.sliding
            }
        });
        let det = p * p - q * q;
        let stop = [
            (q * free[1] - p * free[0]) / det,
            (q * free[0] - p * free[1]) / det,
        ];
        if stop[0].abs() <= bound[0] && stop[1].abs() <= bound[1] {
            return stop;
        }
        let mut f = [0.0_f64; 2];
        for _ in 0..100 {
            let last = f;
            f[0] = (-(free[0] + q * f[1]) / p).clamp(-bound[0], bound[0]);
            f[1] = (-(free[1] + q * f[0]) / p).clamp(-bound[1], bound[1]);
            if f == last {
                break;
            }
        }
        f
    }
}

impl Friction for WheelFriction {
    fn breakaway(&self) -> Wrench<f64> {
        Wrench {
            force: 2.0 * self.sticking,
            moment: 2.0 * HALF_TRACK * self.sticking,
        }
    }

    fn after(&self, body: &Body, plant: &Base, wrench: &Wrench<f64>, dt: f64) -> Body {
        let h = dt / f64::from(STEPS);
        let mut body = *body;
        for _ in 0..STEPS {
            let friction = self.forces(&body.twist, plant, wrench, h);
            let all = Wrench {
                force: wrench.force + friction[0] + friction[1],
                moment: wrench.moment + HALF_TRACK * (friction[0] - friction[1]),
            };
            let stood = body;
            body = body.after(plant, &all, h);
            // Standing is exact: rounding must not make a wheel slide.
            let still = 1e-12;
            let rims = rims(&body.twist).map(|rim| if rim.abs() < still { 0.0 } else { rim });
            body.twist = Twist::new(
                (rims[0] + rims[1]) / 2.0,
                (rims[0] - rims[1]) / (2.0 * HALF_TRACK),
            );
            if stood.twist == Twist::default() && body.twist == Twist::default() {
                body = stood;
            }
        }
        body
    }
}

/// Rim speeds over the floor, right and left \[m/s\].
fn rims(twist: &Twist<f64>) -> [f64; 2] {
    [1.0, -1.0].map(|side| twist.linear + side * HALF_TRACK * twist.angular)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 N at each rim to break away: a wheel with 1.9 N stands for good, with the other one sliding or not; and
    /// what slides loses 1.6 N.
    #[test]
    fn each_wheel_stands_or_slides_by_itself() {
        let friction = WheelFriction {
            sticking: 2.0,
            sliding: 1.6,
        };
        let plant = Base::STANDARD;
        let push = |right: f64, left: f64| Wrench {
            force: right + left,
            moment: HALF_TRACK * (right - left),
        };
        let one = friction.after(&Body::default(), &plant, &push(1.9, 1.9), 1.0);
        assert_eq!(one, Body::default());
        let both = friction.after(&Body::default(), &plant, &push(5.0, 5.0), 0.01);
        // The first of ten steps still breaks away: 3 N instead of 3.4 N on each side.
        let expected = 0.01 * 2.0 * (0.1 * 3.0 + 0.9 * 3.4) / plant.mass;
        assert!((both.twist.linear - expected).abs() < 1e-12);
        assert!(both.twist.angular.abs() < 1e-12);
        // The left wheel pulls and drags the right one with 78 % of what it has left, which stands all the same.
        let pivot = friction.after(&Body::default(), &plant, &push(0.0, 4.0), 0.01);
        let [right, left] = rims(&pivot.twist);
        assert!(right == 0.0 && left > 0.0, "{right} {left}");
    }
}
