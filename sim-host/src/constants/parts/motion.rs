//! The motion law: limits, gains, arrival.

use super::{Writer, at_rest, robot};
use controller_core::motion::{Arrival, Limits, MotionGains, MotionParams, SaturationPolicy};

pub(super) fn motion(out: &mut Writer, params: &MotionParams<f32>) {
    let MotionParams {
        robot: of_robot,
        limits: of_limits,
        gains: of_gains,
        pose_noise_m,
        arrival: of_arrival,
        jump,
        max_tick_s,
    } = params;
    out.open("motion: motion::MotionParams {");
    robot(out, of_robot);
    limits(out, of_limits);
    gains(out, of_gains);
    out.number(
        "pose_noise_m",
        *pose_noise_m,
        "Of the fused position per tick [m].",
    );
    arrival(out, of_arrival);
    match jump {
        None => out.field("jump", "None", "Jumps are declared, not detected."),
        Some(jump) => {
            out.open("jump: Some(motion::JumpThreshold {");
            out.number("distance_m", jump.distance_m, "[m]");
            out.number("heading_rad", jump.heading_rad, "[rad]");
            out.close("}),");
        }
    }
    out.number("max_tick_s", *max_tick_s, "Longest accepted tick [s].");
    out.close("},");
}

fn limits(out: &mut Writer, limits: &Limits<f32>) {
    let Limits {
        speed,
        turn_rate,
        accel,
        brake,
        turn_accel,
        jerk,
        turn_jerk,
        wheel_torque_nm,
        policy,
    } = limits;
    out.open("limits: motion::Limits {");
    out.number("speed", *speed, "[m/s]");
    out.number("turn_rate", *turn_rate, "[rad/s]");
    out.number("accel", *accel, "Away from rest [m/s^2].");
    out.number("brake", *brake, "Towards rest [m/s^2].");
    out.number("turn_accel", *turn_accel, "[rad/s^2]");
    out.number("jerk", *jerk, "[m/s^3]");
    out.number("turn_jerk", *turn_jerk, "[rad/s^3]");
    out.number("wheel_torque_nm", *wheel_torque_nm, "Of each wheel [N m].");
    let policy = match policy {
        SaturationPolicy::KeepCurvature => "KeepCurvature",
        SaturationPolicy::TurnFirst => "TurnFirst",
        SaturationPolicy::DriveFirst => "DriveFirst",
    };
    let about = "Who yields at the torque limit.";
    out.field(
        "policy",
        &format!("motion::SaturationPolicy::{policy}"),
        about,
    );
    out.close("},");
}

fn gains(out: &mut Writer, gains: &MotionGains<f32>) {
    let MotionGains {
        decay,
        longitudinal,
        longitudinal_bound,
        heading,
        lateral,
        slow,
        approach,
        approach_brake,
        speed_loop,
        turn_loop,
        disturbance,
        disturbance_share,
    } = gains;
    out.open("gains: motion::MotionGains {");
    out.number(
        "decay",
        *decay,
        "Of pose neurons and transition offsets [1/s].",
    );
    out.number("longitudinal", *longitudinal, "Along the path [1/s].");
    out.number(
        "longitudinal_bound",
        *longitudinal_bound,
        "Largest speed that it adds [m/s].",
    );
    out.number("heading", *heading, "[1/s]");
    out.number("lateral", *lateral, "Across the path [1/s^2].");
    out.number(
        "slow",
        *slow,
        "Below this speed the lateral correction fades out [m/s].",
    );
    out.number("approach", *approach, "Towards the goal [1/s].");
    out.number(
        "approach_brake",
        *approach_brake,
        "Planned deceleration [m/s^2].",
    );
    out.number("speed_loop", *speed_loop, "[1/s]");
    out.number("turn_loop", *turn_loop, "[1/s]");
    out.number(
        "disturbance",
        *disturbance,
        "Bandwidth of the disturbance estimate [1/s].",
    );
    out.number(
        "disturbance_share",
        *disturbance_share,
        "Largest one, over the wheels' largest.",
    );
    out.close("},");
}

fn arrival(out: &mut Writer, arrival: &Arrival<f32>) {
    let Arrival {
        distance_m,
        heading_rad,
        dwell_s,
        at_rest: rest,
        stall_speed,
        stall_s,
        retries,
    } = arrival;
    out.open("arrival: motion::Arrival {");
    out.number("distance_m", *distance_m, "[m]");
    out.number("heading_rad", *heading_rad, "[rad]");
    out.number("dwell_s", *dwell_s, "[s]");
    out.field("at_rest", at_rest(*rest), "");
    out.number("stall_speed", *stall_speed, "[m/s]");
    out.number("stall_s", *stall_s, "[s]");
    out.field("retries", &retries.to_string(), "");
    out.close("},");
}
