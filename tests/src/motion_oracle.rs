//! The core's values in the oracle's terms: parameters, tasks, reports of the law for a real base.

use controller_core::motion::{
    AtRest, Mode, MotionParams, MotionReport, Outcome, SaturationPolicy, Task,
};
use controller_core::types::{Measured, Pose, Twist};
use nalgebra::{Vector2, Vector3};

use crate::oracle::motion::command::Command;
use crate::oracle::motion::follow::Sample;
use crate::oracle::motion::{Constants, Inputs, Pair, Policy, Row, Rule, law};

/// Parameters as the oracle is given them.
pub fn constants(params: &MotionParams<f64>, rule: Rule) -> Constants {
    let (robot, limits, gains) = (&params.robot, &params.limits, &params.gains);
    let arrival = &params.arrival;
    Constants {
        inertia: Pair::new(robot.mass_kg, robot.inertia_kg_m2),
        radius: Vector2::new(robot.wheels.radius_right_m, robot.wheels.radius_left_m),
        track: robot.wheels.track_m,
        speed: Pair::new(limits.speed, limits.turn_rate),
        accel: Pair::new(limits.accel, limits.turn_accel),
        brake: Pair::new(limits.brake, limits.turn_accel),
        rim_speed: limits.rim_speed,
        jerk: Pair::new(limits.jerk, limits.turn_jerk),
        torque: limits.wheel_torque_nm,
        policy: match limits.policy {
            SaturationPolicy::KeepCurvature => Policy::KeepCurvature,
            SaturationPolicy::TurnFirst => Policy::TurnFirst,
            SaturationPolicy::DriveFirst => Policy::DriveFirst,
        },
        a: gains.decay,
        k1: gains.longitudinal,
        b_v: gains.longitudinal_bound,
        k3: gains.heading,
        c: gains.lateral,
        v_f: gains.slow,
        k4: gains.approach,
        p: gains.approach_brake,
        kappa: Pair::new(gains.speed_loop, gains.turn_loop),
        omega: gains.disturbance,
        disturbance_share: gains.disturbance_share,
        sigma: params.pose_noise_m,
        tolerance: (arrival.distance_m, arrival.heading_rad),
        dwell: arrival.dwell_s,
        release: arrival.at_rest == AtRest::Release,
        stall: (arrival.stall_speed, arrival.stall_s),
        retries: arrival.retries,
        jump: params.jump.map(|jump| (jump.distance_m, jump.heading_rad)),
        rule,
    }
}

/// A posture.
pub fn posture(pose: &Pose<f64>) -> Vector3<f64> {
    Vector3::new(pose.x, pose.y, pose.theta)
}

/// Speed and turn rate.
pub fn pair(twist: &Twist<f64>) -> Pair {
    Pair::new(twist.linear, twist.angular)
}

/// A task.
pub fn task(task: &Task<f64>) -> law::Task {
    match task {
        Task::Follow(reference) => {
            let accel = reference.accel();
            law::Task::Follow(Sample {
                q: posture(reference.pose()),
                twist: pair(reference.twist()),
                accel: Pair::new(accel.linear, accel.angular),
            })
        }
        Task::Park(goal) => law::Task::Park(posture(goal)),
        Task::Drive {
            twist,
            hold_heading,
        } => law::Task::Drive(pair(twist), *hold_heading),
    }
}

/// The oracle goes on from a tick of the core in which a wheel was at its limit. Setting the command back passes on a rounding of the
/// acceleration 1/(κ dt) times as much, from tick to tick for as long as a robot is held: what is compared is each tick.
pub fn take_over(oracle: &mut law::Law, report: &MotionReport<f64>, measured: &Measured<f64>) {
    let (rate, push) = (&report.command_rate, &report.disturbance);
    let command = Command {
        twist: pair(&report.command),
        rate: Pair::new(rate.linear, rate.angular),
    };
    let found = (
        Pair::new(push.force, push.moment),
        Pair::new(report.load.mass, report.load.inertia),
    );
    let torques = Vector2::new(report.torques.right, report.torques.left);
    oracle.take_over(&command, found, &torques, &pair(&measured.twist));
}

/// What is measured.
pub fn inputs(measured: &Measured<f64>) -> Inputs {
    Inputs {
        q: posture(&measured.pose),
        twist: pair(&measured.twist),
    }
}

/// Names of [`numbers`].
pub const NAMES: [&str; 21] = [
    "e_x", "e_y", "e_theta", "v_d", "w_d", "a_d", "alpha_d", "b_v", "b_w", "v_c", "w_c", "a_c",
    "alpha_c", "d_F", "d_N", "load_m", "load_I", "F", "N", "tau_R", "tau_L",
];

/// All numbers of a report.
pub fn numbers(report: &MotionReport<f64>) -> [f64; 21] {
    let MotionReport {
        error,
        desired,
        desired_rate,
        transition_offset,
        command,
        command_rate,
        disturbance,
        load,
        wrench,
        torques,
        ..
    } = report;
    [
        error.x,
        error.y,
        error.theta,
        desired.linear,
        desired.angular,
        desired_rate.linear,
        desired_rate.angular,
        transition_offset.linear,
        transition_offset.angular,
        command.linear,
        command.angular,
        command_rate.linear,
        command_rate.angular,
        disturbance.force,
        disturbance.moment,
        load.mass,
        load.inertia,
        wrench.force,
        wrench.moment,
        torques.right,
        torques.left,
    ]
}

/// All numbers of an oracle's row.
pub fn row_numbers(row: &Row) -> [f64; 21] {
    let (d, c) = (&row.desired, &row.command);
    let pairs = [
        d.twist,
        d.rate,
        row.offset,
        c.twist,
        c.rate,
        row.disturbance,
        row.load,
        row.wrench,
        row.torques,
    ];
    let mut numbers = [row.e.x, row.e.y, row.e.z].into_iter();
    let mut rest = pairs.iter().flat_map(|pair| [pair.x, pair.y]);
    std::array::from_fn(|_| numbers.next().or_else(|| rest.next()).expect("21 numbers"))
}

/// All that a report says beside numbers: limits, jump, outcome, backing, retries.
pub type Said = ([bool; 5], bool, [bool; 3], bool, u8);

/// What a report says.
pub fn said(report: &MotionReport<f64>) -> Said {
    let limited = &report.limited;
    let outcome = [Outcome::Parked, Outcome::OutOfTolerance, Outcome::Stalled];
    (
        [
            limited.speed,
            limited.accel,
            limited.jerk,
            limited.torque,
            limited.disturbance,
        ],
        report.jumped,
        outcome.map(|outcome| outcome == report.outcome),
        report.backing && report.mode == Mode::Parking,
        report.retries,
    )
}

/// What an oracle's row says.
pub fn row_said(row: &Row) -> Said {
    (
        row.limited,
        row.jumped,
        row.outcome,
        row.backing,
        row.retries,
    )
}
