//! Every question to a processor in the loop, with every value it can carry.

use crate::commands::{pose, real, reference, twist};
use proptest::prelude::*;
use protocol::pil::{ParameterSet, Question, WireDemand, WireMeasured, WireReset};

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

pub fn question() -> impl Strategy<Value = Question> {
    prop_oneof![
        Just(Question::Hello),
        Just(Question::Stop),
        Just(Question::GetCounters),
        (reference(), measured()).prop_map(|(reference, measured)| Question::Begin {
            reference,
            measured,
        }),
        (real(), demand(), measured()).prop_map(|(dt, demand, measured)| Question::Tick {
            dt,
            demand,
            measured,
        }),
        parameters().prop_map(Question::Configure),
    ]
}
