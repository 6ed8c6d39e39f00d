//! Every field of the parameters. Patterns are without `..`: a field that is new in the core does not
//! compile until it is written.

use super::writer::{Writer, number};
use controller_core::base::BaseParams;
use controller_core::localiser::{FusionParams, LocaliserParams};
use controller_core::motion::{Arrival, AtRest, Limits, MotionGains, MotionParams, Policy};
use controller_core::motor::{MotorParams, WheelFriction};
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::params::Robot;
use controller_core::wheels::WheelGeometry;

mod safety;

/// What the file names; everything else by its path from there.
pub(super) fn imports(out: &mut Writer, params: &BaseParams<f32>) {
    out.line("use controller_core::base::BaseParams;");
    out.line("use controller_core::safety::{Reaction, Response, Timeout};");
    let motor = if params.motor.is_some() {
        "motor, "
    } else {
        ""
    };
    out.line(&format!(
        "use controller_core::{{localiser, motion, {motor}odometry, params, safety, wheels}};"
    ));
}

pub(super) fn base(out: &mut Writer, params: &BaseParams<f32>) {
    let BaseParams {
        motion: of_motion,
        localiser: of_localiser,
        motor: of_motor,
        watch,
        policy,
        supervisor,
    } = params;
    motion(out, of_motion);
    localiser(out, of_localiser);
    match of_motor {
        Some(params) => motor(out, params),
        None => out.field("motor", "None", "The driver takes torques itself."),
    }
    safety::watch(out, watch);
    safety::policy(out, policy);
    safety::supervisor(out, supervisor);
}

fn motion(out: &mut Writer, params: &MotionParams<f32>) {
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

pub(super) fn robot(out: &mut Writer, robot: &Robot<f32>) {
    let Robot {
        mass_kg,
        inertia_kg_m2,
        wheels: of_wheels,
    } = robot;
    out.open("robot: params::Robot {");
    out.number("mass_kg", *mass_kg, "[kg]");
    out.number(
        "inertia_kg_m2",
        *inertia_kg_m2,
        "About the axle's middle [kg m^2].",
    );
    wheels(out, of_wheels);
    out.close("},");
}

fn wheels(out: &mut Writer, wheels: &WheelGeometry<f32>) {
    let WheelGeometry {
        radius_right_m,
        radius_left_m,
        track_m,
    } = wheels;
    out.open("wheels: wheels::WheelGeometry {");
    out.number("radius_right_m", *radius_right_m, "[m]");
    out.number("radius_left_m", *radius_left_m, "[m]");
    out.number("track_m", *track_m, "Between the wheels [m].");
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
        Policy::KeepCurvature => "KeepCurvature",
        Policy::TurnFirst => "TurnFirst",
        Policy::DriveFirst => "DriveFirst",
    };
    let about = "Who yields at the torque limit.";
    out.field("policy", &format!("motion::Policy::{policy}"), about);
    out.close("},");
}

fn gains(out: &mut Writer, gains: &MotionGains<f32>) {
    let MotionGains {
        decay,
        along,
        along_bound,
        heading,
        across,
        slow,
        approach,
        approach_brake,
        speed_loop,
        turn_loop,
        disturbance,
        disturbance_share,
    } = gains;
    out.open("gains: motion::MotionGains {");
    out.number("decay", *decay, "Of pose neurons and bridges [1/s].");
    out.number("along", *along, "Along the path [1/s].");
    out.number(
        "along_bound",
        *along_bound,
        "Largest speed that it adds [m/s].",
    );
    out.number("heading", *heading, "[1/s]");
    out.number("across", *across, "Across the path [1/s^2].");
    out.number(
        "slow",
        *slow,
        "Below this correction across fades out [m/s].",
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

fn at_rest(rest: AtRest) -> &'static str {
    match rest {
        AtRest::Hold => "motion::AtRest::Hold",
        AtRest::Release => "motion::AtRest::Release",
    }
}

fn localiser(out: &mut Writer, params: &LocaliserParams<f32>) {
    let LocaliserParams {
        odometry: of_odometry,
        fusion: of_fusion,
    } = params;
    let OdometryParams {
        wheels: of_wheels,
        calibration,
        counts_per_turn,
        bandwidth,
    } = of_odometry;
    let Calibration { right, left, track } = calibration;
    out.open("localiser: localiser::LocaliserParams {");
    out.open("odometry: odometry::OdometryParams {");
    wheels(out, of_wheels);
    out.line("// Factors on the lengths above.");
    out.open("calibration: odometry::Calibration {");
    for (name, factor) in [("right", right), ("left", left), ("track", track)] {
        out.number(name, *factor, "");
    }
    out.close("},");
    out.number("counts_per_turn", *counts_per_turn, "Of a wheel.");
    out.number("bandwidth", *bandwidth, "Of the speed estimate [rad/s].");
    out.close("},");
    match of_fusion {
        None => out.field("fusion", "None", "Odometry alone."),
        Some(params) => fusion(out, params),
    }
    out.close("},");
}

fn fusion(out: &mut Writer, params: &FusionParams<f32>) {
    let FusionParams {
        noise_m,
        noise_rad,
        rate_hz,
        bandwidth,
        heading_bandwidth,
        gate,
        relocalise_after,
        drift,
        slide_m_s,
        stale_s,
    } = params;
    out.open("fusion: Some(localiser::FusionParams {");
    out.number("noise_m", *noise_m, "Of a pose [m, standard deviation].");
    out.number("noise_rad", *noise_rad, "[rad, standard deviation]");
    out.number("rate_hz", *rate_hz, "[Hz]");
    out.number(
        "bandwidth",
        *bandwidth,
        "Of the position's correction [rad/s].",
    );
    out.number("heading_bandwidth", *heading_bandwidth, "[rad/s]");
    out.number("gate", *gate, "Standard deviations.");
    out.field(
        "relocalise_after",
        &relocalise_after.to_string(),
        "Outliers that agree.",
    );
    out.number("drift", *drift, "Of the travel of a wheel.");
    out.number("slide_m_s", *slide_m_s, "Of a wheel over the floor [m/s].");
    out.number("stale_s", *stale_s, "[s]");
    out.close("}),");
}

fn motor(out: &mut Writer, params: &MotorParams<f32>) {
    let MotorParams {
        gear_ratio,
        gear_efficiency,
        torque_constant_nm_per_a,
        resistance_ohm,
        supply_v,
        max_current_a,
        friction,
        dead_band,
    } = params;
    let WheelFriction {
        coulomb_nm,
        stiction_nm,
        viscous_nm_s,
        blend_rad_s,
    } = friction;
    out.open("motor: Some(motor::MotorParams {");
    out.number(
        "gear_ratio",
        *gear_ratio,
        "Turns of the motor per turn of the wheel.",
    );
    out.number("gear_efficiency", *gear_efficiency, "");
    let constant = number(*torque_constant_nm_per_a);
    out.field("torque_constant_nm_per_a", &constant, "[N m/A, V s/rad]");
    out.number("resistance_ohm", *resistance_ohm, "[ohm]");
    out.number("supply_v", *supply_v, "Nominal [V].");
    out.number("max_current_a", *max_current_a, "[A]");
    out.open("friction: motor::WheelFriction {");
    out.number("coulomb_nm", *coulomb_nm, "At the wheel [N m].");
    out.number(
        "stiction_nm",
        *stiction_nm,
        "To break loose, beyond that [N m].",
    );
    out.number("viscous_nm_s", *viscous_nm_s, "[N m s/rad]");
    out.number("blend_rad_s", *blend_rad_s, "[rad/s]");
    out.close("},");
    out.number("dead_band", *dead_band, "Share of the duty.");
    out.close("}),");
}
