//! Dry friction: sticks up to a breakaway force, and is smaller once it slides.

use controller_core::types::Wrench;

use crate::ideal::Robot;
use crate::motion_base::{Base, Body};

/// Dry friction of some kind.
pub trait Friction: Sync {
    /// Breakaway force and moment \[N, N m\].
    fn breakaway(&self) -> Wrench<f64>;

    /// The body after `dt` under a held wrench and this friction.
    fn after(&self, body: &Body, plant: &Base, wrench: &Wrench<f64>, dt: f64) -> Body;
}

/// Dry friction of both axes, each like a block on a table.
#[derive(Clone, Copy, Debug)]
pub struct AxisFriction {
    /// Breakaway force and moment \[N, N m\].
    pub sticking: Wrench<f64>,
    /// While it slides.
    pub sliding: Wrench<f64>,
}

/// Steps within a tick: friction changes sign within one of them, not within a tick.
const STEPS: u32 = 10;

impl AxisFriction {
    /// 5 N to break away and 4 N in motion, at wheels that are 0.25 m off the middle.
    pub const WHEELS: Self = Self {
        sticking: Wrench {
            force: 5.0,
            moment: 1.25,
        },
        sliding: Wrench {
            force: 4.0,
            moment: 1.0,
        },
    };
}

impl Friction for AxisFriction {
    fn breakaway(&self) -> Wrench<f64> {
        self.sticking
    }

    fn after(&self, body: &Body, plant: &Base, wrench: &Wrench<f64>, dt: f64) -> Body {
        let h = dt / f64::from(STEPS);
        let (stick, slide) = (&self.sticking, &self.sliding);
        let mut body = *body;
        for _ in 0..STEPS {
            let (v, w) = (body.twist.linear, body.twist.angular);
            let force = net(
                (stick.force, slide.force),
                wrench.force,
                plant.mass * v / h,
                v,
            );
            let moment = net(
                (stick.moment, slide.moment),
                wrench.moment,
                plant.inertia * w / h,
                w,
            );
            body = body.after(plant, &Wrench { force, moment }, h);
            // Standing is exact: rounding must not make it slide.
            if force == -plant.mass * v / h {
                body.twist.linear = 0.0;
            }
            if moment == -plant.inertia * w / h {
                body.twist.angular = 0.0;
            }
        }
        body
    }
}

/// What is left of `pushed`; `stopping` is the force that a moving axis needs to stop within the step.
fn net((stick, slide): (f64, f64), pushed: f64, stopping: f64, speed: f64) -> f64 {
    if speed == 0.0 {
        if pushed.abs() <= stick {
            0.0
        } else {
            pushed - slide * pushed.signum()
        }
    } else {
        let left = pushed - slide * speed.signum();
        if (left + stopping) * speed < 0.0 {
            -stopping
        } else {
            left
        }
    }
}
