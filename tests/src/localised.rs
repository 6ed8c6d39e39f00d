//! The motion controller in closed loop with a localiser, on a robot with encoders.

use controller_core::localiser::{
    Estimate, FusionParams, Localiser, LocaliserParams, ValidLocaliserParams,
};
use controller_core::maths::Libm;
use controller_core::motion::{MotionController, Outcome, ValidMotionParams};
use controller_core::pose_error::{PoseError, pose_error};
use controller_core::shunting::ExactMean;
use controller_core::types::{Accel, Pose, WheelTorques};
use sim_host::mission::BaseSpec as File;

use crate::encoded::{Encoded, odometry};
use crate::fixes::Source;
use crate::ideal::Loop;
use crate::motion_loop::{Order, goal, steady};

/// In double precision.
pub type Controller = MotionController<f64, Libm, ExactMean>;

/// Bandwidth of the speed estimate \[rad/s\].
pub const SPEED: f64 = 50.0;

/// A base with fixes of this noise, 20 a second.
pub fn localisation(file: &File, noise_m: f64, noise_rad: f64) -> ValidLocaliserParams<f64> {
    let params = LocaliserParams {
        odometry: odometry(file, SPEED),
        fusion: Some(FusionParams::for_source(noise_m, noise_rad, 20.0)),
        gyro: None,
    };
    params.validate_with::<Libm>().expect("valid")
}

/// Robot, localiser, controller.
#[derive(Clone, Debug)]
pub struct Localised {
    /// Robot and controller.
    pub drive: Loop<Controller, Encoded>,
    /// The localiser.
    pub localiser: Localiser<f64, 64>,
    /// The last estimate.
    pub estimate: Estimate<f64>,
}

impl Localised {
    /// At rest where `robot` is, and known to be.
    pub fn start(
        motion: &ValidMotionParams<f64>,
        localisation: &ValidLocaliserParams<f64>,
        (file, robot): (&File, Encoded),
        order: &Order,
        dt: f64,
    ) -> Self {
        let localiser =
            Localiser::start(localisation, robot.body.pose, robot.counts()).expect("finite");
        let controller =
            Controller::start(motion, order, &robot.body.measured()).expect("the start is finite");
        Self {
            drive: Loop::new(controller, robot, Encoded::plant(file), dt),
            localiser,
            estimate: Estimate::default(),
        }
    }

    /// The robot alone.
    pub fn coast(&mut self) {
        let torques = self.drive.controller.report().torques;
        self.drive.hold(&torques);
    }

    /// Localiser and controller.
    pub fn take(&mut self, order: &Order, source: &mut Source) {
        let Loop {
            controller,
            body: robot,
            t,
            dt,
            ..
        } = &mut self.drive;
        let accel = expected_accel(controller.motion(), &controller.report().torques);
        let fix = source.poll(*t, &robot.body.pose);
        self.estimate = self
            .localiser
            .update_with_accel::<Libm>(robot.counts(), *dt, &accel, fix.as_ref())
            .expect("the tick is accepted");
        if self.estimate.jumped {
            controller.declare_jump();
        }
        controller
            .step(*dt, order, &self.estimate.measured)
            .expect("the tick is accepted");
    }

    /// The true pose error.
    pub fn error(&self, order: &Order) -> PoseError<f64> {
        pose_error::<f64, Libm>(&goal(order), &self.drive.body.body.pose)
    }

    /// The larger of the wheels' torques over their limit.
    pub fn load(&self) -> f64 {
        let controller = &self.drive.controller;
        let torques = &controller.report().torques;
        let limit = controller.motion().params().limits.wheel_torque_nm;
        torques.right.abs().max(torques.left.abs()) / limit
    }
}

/// The accelerations that odometry is given: those of the torques.
pub fn expected_accel(motion: &ValidMotionParams<f64>, torques: &WheelTorques<f64>) -> Accel<f64> {
    let wrench = motion.wheels().wrench(torques);
    let robot = &motion.params().robot;
    Accel::new(
        wrench.force / robot.mass_kg,
        wrench.moment / robot.inertia_kg_m2,
    )
}

/// What a run came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct End {
    /// It says so.
    pub parked: bool,
    /// Since when it says so \[s\].
    pub parked_s: f64,
    /// How often it was parked and then not.
    pub left_goal: u32,
    /// True distance to the goal and heading error at the end \[m, rad\].
    pub off: (f64, f64),
    /// Largest torque over its limit at rest.
    pub rest: f64,
}

impl End {
    /// After a tick; torques count as those at rest from `rest_s` on.
    fn see(&mut self, run: &Localised, order: &Order, rest_s: f64) {
        let parked = run.drive.controller.report().outcome == Outcome::Parked;
        if parked && !self.parked {
            self.parked_s = run.drive.t;
        }
        self.left_goal += u32::from(self.parked && !parked);
        self.parked = parked;
        if run.drive.t > rest_s {
            self.rest = self.rest.max(run.load());
        }
        let error = run.error(order);
        self.off = (error.x.hypot(error.y), error.theta.abs());
    }

    /// The worst of many, and how many of them are not parked.
    pub fn worst(runs: &[Self]) -> (Self, usize) {
        let mut all = Self::default();
        for run in runs {
            all = Self {
                parked: true,
                parked_s: all.parked_s.max(run.parked_s),
                left_goal: all.left_goal + run.left_goal,
                off: (all.off.0.max(run.off.0), all.off.1.max(run.off.1)),
                rest: all.rest.max(run.rest),
            };
        }
        (all, runs.iter().filter(|run| !run.parked).count())
    }
}

/// The paper's curve at 0.4 m/s and 0.15 rad/s from 0.3 m beside it, then parking at its end.
pub fn mission(
    motion: &ValidMotionParams<f64>,
    localisation: &ValidLocaliserParams<f64>,
    file: &File,
    source: &mut Source,
    dt: f64,
) -> End {
    let path = steady(0.4, 0.15);
    let target = Order::Park(goal(&path(10.0)));
    let robot = Encoded::new(file, Pose::new(0.0, 0.3, 0.0));
    let mut run = Localised::start(motion, localisation, (file, robot), &path(0.0), dt);
    let (mut parking, mut end) = (false, End::default());
    while run.drive.t < 30.0 {
        let left = (10.0 - run.drive.t).max(0.0) * 0.4 + run.error(&path(run.drive.t)).x;
        let speed = run.drive.controller.report().command.linear;
        parking |= left <= motion.hand_over_distance(speed) || run.drive.t > 10.0;
        run.coast();
        run.take(&if parking { target } else { path(run.drive.t) }, source);
        end.see(&run, &target, 25.0);
    }
    end
}

/// Parking at the origin from rest at `start` for 20 s.
pub fn park(
    motion: &ValidMotionParams<f64>,
    localisation: &ValidLocaliserParams<f64>,
    file: &File,
    start: Pose<f64>,
    source: &mut Source,
    dt: f64,
) -> End {
    let home = Order::Park(Pose::default());
    let mut run = Localised::start(
        motion,
        localisation,
        (file, Encoded::new(file, start)),
        &home,
        dt,
    );
    let mut end = End::default();
    while run.drive.t < 20.0 {
        run.coast();
        run.take(&home, source);
        end.see(&run, &home, 15.0);
    }
    end
}
