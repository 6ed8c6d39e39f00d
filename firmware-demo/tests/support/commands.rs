//! Every command there is, with every value it can carry.

use controller_core::safety::{PolicyParams, Reaction, Response, Timeout};
use proptest::prelude::*;
use protocol::{
    Command, Excite, FieldParams, TimedSample, WireCalibration, WireGains, WireLimits, WirePose,
    WireReference, WireTimeouts, WireTwist, WireYield,
};

/// All bit patterns, so also NaN with payloads, infinities, both zeros and subnormals.
pub fn real() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits)
}

pub fn pose() -> impl Strategy<Value = WirePose> {
    (real(), real(), real()).prop_map(|(x, y, theta)| WirePose { x, y, theta })
}

pub fn twist() -> impl Strategy<Value = WireTwist> {
    (real(), real()).prop_map(|(v, w)| WireTwist { v, w })
}

pub fn reference() -> impl Strategy<Value = WireReference> {
    (pose(), twist(), twist(), real()).prop_map(|(pose, twist, accel, left)| WireReference {
        pose,
        twist,
        accel,
        left,
    })
}

fn timeout() -> impl Strategy<Value = Timeout> {
    prop_oneof![any::<u32>().prop_map(Timeout::AfterUs), Just(Timeout::Off)]
}

pub fn field() -> impl Strategy<Value = FieldParams> {
    let reaction = prop_oneof![
        Just(Reaction::Ignore),
        Just(Reaction::ControlledStop),
        Just(Reaction::Brake),
        Just(Reaction::Release),
    ];
    let response =
        (reaction, any::<bool>()).prop_map(|(reaction, latch)| Response { reaction, latch });
    let yields = prop_oneof![
        Just(WireYield::KeepCurvature),
        Just(WireYield::TurnFirst),
        Just(WireYield::DriveFirst),
    ];
    (
        prop::array::uniform12(real()),
        prop::array::uniform9(real()),
        prop::array::uniform3(real()),
        (timeout(), timeout(), timeout()),
        (response.clone(), response),
        yields,
    )
        .prop_map(
            |(gains, limits, [right, left, track], times, responses, policy)| {
                let [
                    decay,
                    longitudinal,
                    longitudinal_bound,
                    heading,
                    lateral,
                    slow,
                    approach,
                    approach_brake,
                    rest @ ..,
                ] = gains;
                let [speed_loop, turn_loop, disturbance, disturbance_share] = rest;
                let [
                    speed,
                    turn_rate,
                    rim_speed,
                    accel,
                    brake,
                    turn_accel,
                    jerk,
                    turn_jerk,
                    wheel_torque_nm,
                ] = limits;
                let (measurement, pose, command) = times;
                FieldParams {
                    gains: WireGains {
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
                    },
                    limits: WireLimits {
                        speed,
                        turn_rate,
                        rim_speed,
                        accel,
                        brake,
                        turn_accel,
                        jerk,
                        turn_jerk,
                        wheel_torque_nm,
                        policy,
                    },
                    calibration: WireCalibration { right, left, track },
                    timeouts: WireTimeouts {
                        measurement,
                        pose,
                        command,
                    },
                    policy: PolicyParams {
                        measurement_stale: responses.0,
                        goal_unreachable: responses.1,
                        ..PolicyParams::DEFAULT
                    },
                }
            },
        )
}

pub fn command() -> impl Strategy<Value = Command> {
    prop_oneof![
        Just(Command::Heartbeat),
        Just(Command::Arm),
        Just(Command::Stop),
        Just(Command::ResetFault),
        Just(Command::GetCounters),
        pose().prop_map(|goal| Command::Park { goal }),
        (real(), reference())
            .prop_map(|(t, reference)| Command::Sample(TimedSample { t, reference })),
        field().prop_map(Command::SetParameters),
        any::<bool>().prop_map(|brake| Command::EmergencyStop { brake }),
        pose().prop_map(|pose| Command::SetPose { pose }),
        (real(), real(), any::<bool>()).prop_map(|(v, w, hold_heading)| Command::Drive {
            twist: WireTwist { v, w },
            hold_heading,
        }),
        (pose(), real()).prop_map(|(pose, age_s)| Command::Fix { pose, age_s }),
        Just(Command::SaveParameters),
        Just(Command::LoadDefaults),
        Just(Command::GetParameters),
        (prop::array::uniform5(real()), any::<u32>()).prop_map(|(numbers, seed)| {
            let [length_m, width_m, speed, turn_rate, duration_s] = numbers;
            Command::Excite(Excite {
                length_m,
                width_m,
                speed,
                turn_rate,
                duration_s,
                seed,
            })
        }),
    ]
}
