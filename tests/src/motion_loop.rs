//! The motion controller in closed loop with a robot, and references for it.

use std::f64::consts::PI;

use controller_core::maths::{Libm, Maths};
use controller_core::motion::{MotionController, MotionReport, Task, ValidMotionParams};
use controller_core::pose_error::{PoseError, pose_error};
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronUpdate;
use controller_core::types::{Accel, Measured, Pose, Twist, WheelTorques, Wrench};

use crate::ideal::Loop;
use crate::motion_base::{Base, Body, pose};
use crate::motion_friction::Friction;

/// A task in double precision, from which those of other scalars are made.
pub type Order = Task<f64>;

/// The motion controller with its robot.
pub type Drive<T, M, U> = Loop<MotionController<T, M, U>, Body>;

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> Drive<T, M, U> {
    /// At t = 0.
    pub fn start(
        motion: &ValidMotionParams<T>,
        plant: Base,
        body: Body,
        order: &Order,
        dt: f64,
    ) -> Self {
        let task = convert::<T, M>(order);
        let controller =
            MotionController::start(motion, &task, &body.measured()).expect("the start is finite");
        Self::new(controller, body, plant, dt)
    }

    /// Holds the last torque for a tick and takes the next one, for what `order` makes of its time.
    pub fn advance(&mut self, order: impl Fn(f64) -> Order) -> &MotionReport<T> {
        self.coast(&Wrench::default());
        let task = order(self.t);
        self.take(&task, &self.body.measured())
    }

    /// The robot alone, over one tick, with a push.
    pub fn coast(&mut self, push: &Wrench<f64>) {
        let applied = self.applied();
        let wrench = Wrench {
            force: applied.force + push.force,
            moment: applied.moment + push.moment,
        };
        self.hold(&wrench);
    }

    /// The robot alone, over one tick, against dry friction.
    pub fn coast_against(&mut self, friction: &impl Friction) {
        let wrench = self.applied();
        self.roll(|body, plant, dt| friction.after(body, plant, &wrench, dt));
    }

    /// The controller alone.
    pub fn take(&mut self, order: &Order, measured: &Measured<T>) -> &MotionReport<T> {
        let task = convert::<T, M>(order);
        self.controller
            .step(T::from_f64(self.dt), &task, measured)
            .expect("the tick is accepted")
    }

    /// The last report.
    pub fn report(&self) -> &MotionReport<T> {
        self.controller.report()
    }

    /// Force and moment at the wheels.
    pub fn applied(&self) -> Wrench<f64> {
        let WheelTorques { right, left } = self.report().torques;
        let (right, left) = (right.to_f64(), left.to_f64());
        let (radius, half_track) = (self.plant.radius, 0.5 * self.plant.track);
        Wrench {
            force: (right + left) / radius,
            moment: half_track * (right - left) / radius,
        }
    }

    /// The true pose error.
    pub fn error(&self, order: &Order) -> PoseError<f64> {
        let goal = match order {
            Task::Follow(reference) => *reference.pose(),
            Task::Park(goal) => *goal,
            // Where it is is where it should be.
            Task::Drive { .. } => self.body.pose,
        };
        pose_error::<f64, Libm>(&goal, &self.body.pose)
    }
}

fn convert<T: Scalar, M: Maths<T>>(order: &Order) -> Task<T> {
    let f = T::from_f64;
    match order {
        Task::Park(goal) => Task::Park(pose(goal)),
        Task::Follow(reference) => {
            let (twist, accel) = (reference.twist(), reference.accel());
            Task::Follow(Reference::new_with::<M>(
                pose(reference.pose()),
                Twist::new(f(twist.linear), f(twist.angular)),
                Accel::new(f(accel.linear), f(accel.angular)),
            ))
        }
        Task::Drive { .. } => order.cast_with::<T, M>(),
    }
}

/// Constant speed and turn rate from the origin along x.
pub fn steady(v: f64, w: f64) -> impl Fn(f64) -> Order + Sync + Copy {
    let path = ConstantTwist {
        start: Pose::default(),
        twist: Twist::new(v, w),
    };
    move |t| Task::Follow(path.at::<Libm>(t))
}

/// Parking at the origin.
pub fn home() -> impl Fn(f64) -> Order + Sync + Copy {
    |_| Task::Park(Pose::default())
}

/// The pose of an order.
pub fn goal(order: &Order) -> Pose<f64> {
    match order {
        Task::Follow(reference) => *reference.pose(),
        Task::Park(goal) => *goal,
        Task::Drive { .. } => panic!("a velocity order has no pose"),
    }
}

/// Poses from rest around the origin: 8 radii, 12 bearings, 12 headings.
pub fn ring() -> Vec<Body> {
    let mut starts = Vec::new();
    for radius in [0.1, 0.2, 0.35, 0.5, 0.8, 1.2, 2.0, 3.0] {
        for bearing in 0..12 {
            let (sine, cosine) = (f64::from(bearing) * PI / 6.0).sin_cos();
            for heading in 0..12 {
                let theta = f64::from(heading) * PI / 6.0;
                starts.push(Body::at(radius * cosine, radius * sine, theta));
            }
        }
    }
    starts
}

/// The 90 states at a hand-over: 0.4 m short of the goal at 0.4 m/s.
pub fn hand_over_states() -> Vec<Body> {
    let mut starts = Vec::new();
    for across in -2_i32..=2 {
        for turn in -4_i32..=4 {
            for w in [0.0, 0.15] {
                // The robot whose error is (e_x, e_y, e_θ) at the origin's goal.
                let (ex, ey) = (0.4, 0.1 * f64::from(across));
                let theta = -0.1 * f64::from(turn);
                let (sine, cosine) = theta.sin_cos();
                starts.push(Body {
                    pose: Pose::new(
                        -(ex * cosine - ey * sine),
                        -(ex * sine + ey * cosine),
                        theta,
                    ),
                    twist: Twist::new(0.4, w),
                });
            }
        }
    }
    starts
}
