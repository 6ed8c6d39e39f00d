//! Detectors, policy, supervisor.

use super::{Writer, at_rest, robot};
use controller_core::safety::supervisor::{Emergency, IdleOutput, RestLimits, SupervisorParams};
use controller_core::safety::{
    CurrentDetectorParams, DetectorParams, FaultKind, PolicyParams, Reaction, SlipDetectorParams,
    StuckDetectorParams, SupplyDetectorParams, TickDetectorParams, WheelDetectorParams,
};

use crate::constants::writer::whole;

pub(super) fn detectors(out: &mut Writer, params: &DetectorParams<f32>) {
    let DetectorParams {
        period_us,
        robot: of_robot,
        measurement,
        pose,
        command,
        ticks,
        wheels: of_wheels,
        current,
        supply,
    } = params;
    out.open("detectors: safety::DetectorParams {");
    out.field("period_us", &whole(*period_us), "[us]");
    robot(out, of_robot);
    out.timeout(
        "measurement",
        *measurement,
        "Encoders without a reading [us].",
    );
    out.timeout("pose", *pose, "External poses missing [us].");
    out.timeout("command", *command, "Host or reference silent [us].");
    let TickDetectorParams {
        late,
        row,
        of_64,
        long,
    } = ticks;
    out.open("ticks: safety::TickDetectorParams {");
    out.timeout("late", *late, "[us]");
    out.field("row", &row.to_string(), "");
    out.field("of_64", &of_64.to_string(), "");
    out.timeout("long", *long, "[us]");
    out.close("},");
    wheels(out, of_wheels);
    let CurrentDetectorParams { limit_a, after } = current;
    out.open("current: safety::CurrentDetectorParams {");
    out.number("limit_a", *limit_a, "[A]");
    out.timeout("after", *after, "[us]");
    out.close("},");
    let SupplyDetectorParams {
        low_v,
        recovered_v,
        after,
    } = supply;
    out.open("supply: safety::SupplyDetectorParams {");
    out.number("low_v", *low_v, "[V]");
    out.number("recovered_v", *recovered_v, "[V]");
    out.timeout("after", *after, "[us]");
    out.close("},");
    out.close("},");
}

fn wheels(out: &mut Writer, wheels: &WheelDetectorParams<f32>) {
    let WheelDetectorParams {
        counts_per_turn,
        load_nm,
        stuck,
        reversed,
        slip,
    } = wheels;
    out.open("wheels: safety::WheelDetectorParams {");
    out.number("counts_per_turn", *counts_per_turn, "Of a wheel.");
    out.number("load_nm", *load_nm, "From outside, at each wheel [N m].");
    let StuckDetectorParams {
        torque_nm,
        speed_rad_s,
        after,
    } = stuck;
    out.open("stuck: safety::StuckDetectorParams {");
    out.number("torque_nm", *torque_nm, "[N m]");
    out.number("speed_rad_s", *speed_rad_s, "[rad/s]");
    out.timeout("after", *after, "[us]");
    out.close("},");
    out.timeout("reversed", *reversed, "[us]");
    let SlipDetectorParams {
        accel_rad_s2,
        speed_m_s,
        after,
    } = slip;
    out.open("slip: safety::SlipDetectorParams {");
    out.number("accel_rad_s2", *accel_rad_s2, "[rad/s^2]");
    out.number("speed_m_s", *speed_m_s, "[m/s]");
    out.timeout("after", *after, "[us]");
    out.close("},");
    out.close("},");
}

pub(super) fn policy(out: &mut Writer, policy: &PolicyParams) {
    out.line("// What is done about each kind of fault; latched ones need a reset.");
    out.open("policy: safety::PolicyParams {");
    // The policy's fields have the kinds' names; one too few does not compile.
    for kind in FaultKind::ALL {
        let response = policy.get(kind);
        let reaction = match response.reaction {
            Reaction::Ignore => "Ignore",
            Reaction::ControlledStop => "ControlledStop",
            Reaction::Brake => "Brake",
            Reaction::Release => "Release",
        };
        let made = if response.latch { "latched" } else { "passing" };
        let value = format!("Response::{made}(Reaction::{reaction})");
        out.field(kind.name(), &value, "");
    }
    out.close("},");
}

pub(super) fn supervisor(out: &mut Writer, params: &SupervisorParams) {
    let SupervisorParams {
        stop_limit,
        brake_limit,
        rest,
        emergency,
        parked,
        idle_output,
    } = params;
    let RestLimits {
        speed_m_s,
        turn_rad_s,
        dwell_us,
    } = rest;
    out.open("supervisor: safety::supervisor::SupervisorParams {");
    out.timeout("stop_limit", *stop_limit, "[us]");
    out.timeout("brake_limit", *brake_limit, "[us]");
    out.open("rest: safety::supervisor::RestLimits {");
    out.number("speed_m_s", *speed_m_s, "[m/s]");
    out.number("turn_rad_s", *turn_rad_s, "[rad/s]");
    out.field("dwell_us", &whole(*dwell_us), "[us]");
    out.close("},");
    let emergency = match emergency {
        Emergency::Brake => "safety::supervisor::Emergency::Brake",
        Emergency::Release => "safety::supervisor::Emergency::Release",
    };
    out.field("emergency", emergency, "");
    out.field("parked", at_rest(*parked), "");
    let idle_output = match idle_output {
        IdleOutput::Release => "safety::supervisor::IdleOutput::Release",
        IdleOutput::Brake => "safety::supervisor::IdleOutput::Brake",
    };
    out.field("idle_output", idle_output, "");
    out.close("},");
}
