//! Every command there is, with every value it can carry.

use controller_core::safety::{PolicyParams, Reaction, Response, Timeout};
use firmware_demo::protocol::{
    Command, FieldParams, ParameterSet, TimedSample, WireCalibration, WireDemand, WireGains,
    WireLimits, WireMeasured, WirePose, WireReference, WireReset, WireTimeouts, WireTwist,
    WireYield,
};
use proptest::prelude::*;

/// All bit patterns, so also NaN with payloads, infinities, both zeros and subnormals.
fn real() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits)
}

fn pose() -> impl Strategy<Value = WirePose> {
    (real(), real(), real()).prop_map(|(x, y, theta)| WirePose { x, y, theta })
}

fn twist() -> impl Strategy<Value = WireTwist> {
    (real(), real()).prop_map(|(v, w)| WireTwist { v, w })
}

fn reference() -> impl Strategy<Value = WireReference> {
    (pose(), twist(), twist()).prop_map(|(pose, twist, accel)| WireReference { pose, twist, accel })
}

fn measured() -> impl Strategy<Value = WireMeasured> {
    (pose(), twist()).prop_map(|(pose, twist)| WireMeasured { pose, twist })
}

fn demand() -> impl Strategy<Value = WireDemand> {
    prop_oneof![
        reference().prop_map(WireDemand::Track),
        (reference(), pose())
            .prop_map(|(reference, goal)| WireDemand::HandOver { reference, goal }),
        Just(WireDemand::Park),
    ]
}

fn parameters() -> impl Strategy<Value = ParameterSet> {
    let reset = prop_oneof![
        Just(WireReset::TorqueContinuous),
        Just(WireReset::Printed),
        Just(WireReset::Zero),
    ];
    (
        prop::array::uniform18(real()),
        reset,
        prop::option::of(real()),
    )
        .prop_map(|(values, reset, max_wheel_torque)| {
            let [mass, inertia, radius_right, radius_left, track, rest @ ..] = values;
            let [
                k1,
                k2,
                k3,
                k_d1,
                k_d2,
                k4,
                k5,
                k_c1,
                k_c2,
                a,
                b,
                d,
                max_tick,
            ] = rest;
            ParameterSet {
                mass,
                inertia,
                radius_right,
                radius_left,
                track,
                k1,
                k2,
                k3,
                k_d1,
                k_d2,
                k4,
                k5,
                k_c1,
                k_c2,
                a,
                b,
                d,
                reset,
                max_wheel_torque,
                max_tick,
            }
        })
}

fn timeout() -> impl Strategy<Value = Timeout> {
    prop_oneof![any::<u32>().prop_map(Timeout::AfterUs), Just(Timeout::Off)]
}

pub fn field() -> impl Strategy<Value = FieldParams> {
    let reaction = prop_oneof![
        Just(Reaction::RideOut),
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
        prop::array::uniform8(real()),
        prop::array::uniform3(real()),
        (timeout(), timeout(), timeout()),
        (response.clone(), response),
        yields,
    )
        .prop_map(
            |(gains, limits, [right, left, track], times, responses, policy)| {
                let [
                    decay,
                    along,
                    along_bound,
                    heading,
                    across,
                    slow,
                    approach,
                    approach_brake,
                    rest @ ..,
                ] = gains;
                let [speed_loop, turn_loop, disturbance, disturbance_share] = rest;
                let [
                    speed,
                    turn_rate,
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
                    },
                    limits: WireLimits {
                        speed,
                        turn_rate,
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
                        gave_up: responses.1,
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
        (reference(), measured()).prop_map(|(reference, measured)| Command::Begin {
            reference,
            measured,
        }),
        (real(), demand(), measured()).prop_map(|(dt, demand, measured)| Command::Tick {
            dt,
            demand,
            measured,
        }),
        parameters().prop_map(Command::Configure),
        field().prop_map(Command::SetParameters),
        any::<bool>().prop_map(|brake| Command::EmergencyStop { brake }),
        pose().prop_map(|pose| Command::SetPose { pose }),
        (pose(), real()).prop_map(|(pose, age_s)| Command::Fix { pose, age_s }),
        Just(Command::SaveParameters),
        Just(Command::LoadDefaults),
        Just(Command::GetParameters),
    ]
}
