//! The conditions, and what an independent calculation expects of the paper's law under them.

use super::condition::{Condition, Disturbance, Expected, Group, Range};
use crate::precision::Precision;
use controller_core::types::Wrench;

const NOMINAL: Disturbance = Disturbance::NOMINAL;

/// Settling times and final position errors of line and curve; a time of 0 stands for none.
fn both(line: (Range, Range), curve: (Range, Range)) -> [Expected; 2] {
    [line, curve].map(|(settling, final_mm)| Expected {
        settling_s: (settling.1 > 0.0).then_some(settling),
        final_mm: (final_mm.1 > 0.0).then_some(final_mm),
        ..Expected::default()
    })
}

const fn one(value: f64) -> Range {
    (value, value)
}

const NONE: Range = (0.0, 0.0);

fn condition(
    name: impl Into<String>,
    group: Group,
    expected: [Expected; 2],
    disturbance: Disturbance,
) -> Condition {
    Condition {
        name: name.into(),
        group,
        disturbance,
        expected,
    }
}

/// All conditions, in the order of the table.
pub fn catalogue() -> Vec<Condition> {
    let mut all = vec![condition(
        "nominal, 10 ms",
        Group::Nominal,
        sampled(),
        NOMINAL,
    )];
    all.extend(periods());
    all.extend(inertias());
    all.extend(saturations());
    all.extend(noises());
    all.extend(latencies());
    all.extend(others());
    all
}

/// Any period from 1 to 50 ms.
fn sampled() -> [Expected; 2] {
    both(((4.95, 4.98), one(0.9)), ((5.20, 5.21), one(1.2)))
}

fn periods() -> Vec<Condition> {
    let periods = [0.001, 0.002, 0.005, 0.02, 0.05, 0.1, 0.25, 0.3];
    let named = periods.map(|period_s: f64| {
        let expected = if period_s < 0.06 {
            sampled()
        } else {
            [Expected::default(); 2]
        };
        let name = format!("period {} ms", (1.0e3 * period_s).round());
        let disturbance = Disturbance {
            period_s,
            ..NOMINAL
        };
        condition(name, Group::Period, expected, disturbance)
    });
    named.into()
}

fn inertias() -> Vec<Condition> {
    let near = [0.7, 1.0, 1.3];
    let grid = near.iter().flat_map(|m| near.map(|i| (*m, i)));
    let near = grid.filter(|pair| *pair != (1.0, 1.0)).map(|pair| {
        let expected = both(((4.91, 5.06), (0.6, 1.3)), ((5.06, 5.34), (0.4, 2.1)));
        (pair, expected)
    });
    let far = [
        ((2.0, 2.0), both((one(4.87), NONE), (one(4.89), NONE))),
        ((4.0, 4.0), both((one(5.13), NONE), (one(6.13), NONE))),
    ];
    let named = near
        .chain(far)
        .map(|((mass_factor, inertia_factor), expected)| {
            let name = format!("m × {mass_factor}, I × {inertia_factor}");
            let disturbance = Disturbance {
                mass_factor,
                inertia_factor,
                ..NOMINAL
            };
            condition(name, Group::Inertia, expected, disturbance)
        });
    named.collect()
}

fn saturations() -> Vec<Condition> {
    let lost = Expected {
        fails: true,
        ..Expected::default()
    };
    // At 20 N and 20 N m the line is as without a limit.
    let line = both(((4.95, 4.98), one(0.9)), (NONE, NONE));
    let rows = [
        ((20.0, 20.0), line),
        ((15.0, 10.0), both((one(5.04), NONE), (one(4.82), NONE))),
        ((10.0, 8.0), both((one(5.15), NONE), (one(5.85), NONE))),
        ((10.0, 5.0), [Expected::default(), lost]),
    ];
    let named = rows.map(|((force, moment), expected)| {
        let disturbance = Disturbance {
            saturation: Some(Wrench { force, moment }),
            // With half a newton metre to turn 15 kg m² a detour takes its time.
            duration_s: 40.0,
            ..NOMINAL
        };
        condition(
            format!("limit {force} N, {moment} N m"),
            Group::Saturation,
            expected,
            disturbance,
        )
    });
    named.into()
}

fn noises() -> Vec<Condition> {
    let parked = |mm: f64, moment: Option<f64>| {
        [Expected {
            final_mm: Some(one(mm)),
            moment_std_nm: moment,
            ..Expected::default()
        }; 2]
    };
    let pose = |sigma: f64| Disturbance {
        position_noise_m: sigma,
        heading_noise_rad: sigma,
        ..NOMINAL
    };
    let twist = Disturbance {
        twist_noise: 0.05,
        ..NOMINAL
    };
    vec![
        condition(
            "pose noise 5 mm, 5 mrad",
            Group::Noise,
            parked(1.1, Some(0.78)),
            pose(0.005),
        ),
        condition(
            "pose noise 20 mm, 20 mrad",
            Group::Noise,
            parked(2.6, Some(3.1)),
            pose(0.020),
        ),
        condition(
            "twist noise 0.05",
            Group::Noise,
            parked(3.3, Some(3.8)),
            twist,
        ),
    ]
}

fn latencies() -> Vec<Condition> {
    // "Parked the same" as without latency.
    let rows = [
        (0.02, both((one(4.97), one(0.9)), (one(5.14), one(1.2)))),
        (0.05, [Expected::default(); 2]),
        (0.10, both((one(5.28), NONE), (one(5.12), NONE))),
        (0.15, never()),
        (0.25, never()),
    ];
    let named = rows.map(|(pose_latency_s, expected)| {
        let disturbance = Disturbance {
            pose_latency_s,
            ..NOMINAL
        };
        let name = format!("poses {} ms late", (1.0e3 * pose_latency_s).round());
        condition(name, Group::Latency, expected, disturbance)
    });
    named.into()
}

/// The lag of v_r times the latency is wider than the band.
fn never() -> [Expected; 2] {
    [Expected {
        fails: true,
        ..Expected::default()
    }; 2]
}

fn others() -> Vec<Condition> {
    let pushed = Disturbance {
        push_n: -5.0,
        ..NOMINAL
    };
    // 4 N in all, 1.4 % of the weight: a gear motor in good order.
    let rubbed = Disturbance {
        wheel_friction_nm: 0.2,
        ..NOMINAL
    };
    let narrow = Disturbance {
        precision: Precision::F32,
        ..NOMINAL
    };
    let together = Disturbance {
        period_s: 0.02,
        pose_latency_s: 0.02,
        mass_factor: 1.3,
        inertia_factor: 0.7,
        position_noise_m: 0.005,
        heading_noise_rad: 0.005,
        saturation: Some(Wrench {
            force: 30.0,
            moment: 40.0,
        }),
        ..NOMINAL
    };
    vec![
        // F/(k_c1 k4) along the goal: no integral action. The curve adds what it leaves across.
        condition(
            "5 N against",
            Group::Force,
            both((NONE, one(46.3)), (NONE, NONE)),
            pushed,
        ),
        condition(
            "wheel friction 0.2 N m",
            Group::Force,
            [Expected::default(); 2],
            rubbed,
        ),
        condition("single precision", Group::Precision, sampled(), narrow),
        condition(
            "all together",
            Group::Together,
            both((one(5.04), one(1.8)), (one(5.22), one(2.1))),
            together,
        ),
    ]
}
