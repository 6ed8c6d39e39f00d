//! Every command there is, with every value it can carry.

use firmware_demo::protocol::{
    Command, ParameterSet, TimedSample, WireDemand, WireMeasured, WirePose, WireReference,
    WireReset, WireTwist,
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
        parameters().prop_map(Command::SetParameters),
    ]
}
