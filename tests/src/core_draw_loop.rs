//! Strategies of closed loops: gains, starts, references and hand-overs, feasible or not.

use nalgebra::{Matrix2, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

use crate::oracle::{OracleLaw, Params, Reference, Reset, Scenario, Switch};

/// Every gain and constant within a factor of three of the recommended ones, k_c apart from k_d, B from D.
pub fn params() -> impl Strategy<Value = Params> {
    let factor = || (-1.0..1.0_f64).prop_map(|exponent| 3_f64.powf(exponent));
    prop::array::uniform14(factor()).prop_map(|f| {
        let p = Params::recommended();
        Params {
            m: f[0] * p.m,
            inertia: f[1] * p.inertia,
            k1: f[2] * p.k1,
            k2: f[3] * p.k2,
            k3: f[4] * p.k3,
            k4: f[5] * p.k4,
            k5: f[6] * p.k5,
            kd1: f[7] * p.kd1,
            kd2: f[8] * p.kd2,
            kc1: f[9] * p.kc1,
            kc2: f[10] * p.kc2,
            a: f[11] * p.a,
            b: f[12] * p.b / 3.0,
            d: f[13] * p.d / 3.0,
            ..p
        }
    })
}

/// A posture within 3 m with any heading.
pub fn posture() -> impl Strategy<Value = Vector3<f64>> {
    (-3.0..3.0, -3.0..3.0, -PI..PI).prop_map(|(x, y, theta)| Vector3::new(x, y, theta))
}

/// A reference speed: ordinary, backward, tiny, or none.
fn speed() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1.5..1.5_f64,
        1 => -1e-3..1e-3_f64,
        1 => -1e-9..1e-9_f64,
        1 => Just(0.0),
    ]
}

/// A reference whose speed and turn rate may swing.
fn reference() -> impl Strategy<Value = Reference> {
    let swing = || prop_oneof![Just(0.0), -0.5..0.5_f64];
    (posture(), speed(), -1.0..1.0_f64, swing(), swing()).prop_map(|(q0, v0, w0, v1, w1)| {
        Reference {
            v1,
            w1,
            omega_v: 2.0,
            omega_w: 3.0,
            ..Reference::steady(q0.into(), v0, w0)
        }
    })
}

/// A start anywhere at any moderate twist, a hand-over within the first half second to a goal anywhere.
pub fn scenario() -> impl Strategy<Value = Scenario> {
    let twist = (-1.0..1.0, -1.5..1.5).prop_map(|(v, w)| Vector2::new(v, w));
    (
        params(),
        reference(),
        posture(),
        twist,
        0.01..0.5_f64,
        posture(),
    )
        .prop_map(|(params, reference, q0, twist0, at, target)| Scenario {
            params,
            law: OracleLaw::Neural,
            reference,
            q0,
            twist0,
            duration: 0.8,
            switch: Some(Switch {
                at,
                target,
                reset: Reset::Corrected,
            }),
            effort: Matrix2::identity(),
        })
}
