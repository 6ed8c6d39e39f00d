//! No false alarms: what sound bases do, however hard, is no finding.

use controller_core::hal::WheelCounts;
use controller_core::safety::{DetectorInputs, DetectorParams, Monitor};
use controller_core::types::Wrench;
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Order, home, ring, steady};
use tests::motion_tracking::Exact;

/// Drives `plant` with what the controller believes to be `base`; every tick's active faults have to be none.
fn quiet(
    name: &str,
    (base, plant): (Base, Base),
    body: Body,
    (dt, end_s): (f64, f64),
    push: impl Fn(f64) -> Wrench<f64>,
    order: impl Fn(f64) -> Order,
) {
    let params = base.exact();
    let motion = params.validate().expect("valid");
    let period_us = (1e6 * dt).round() as u32;
    for counts in [256.0, 4096.0] {
        let settings = DetectorParams::for_base(&params, counts, period_us);
        let mut monitor = Monitor::new(&settings.validate().expect("valid"));
        let mut drive = Exact::start(&motion, plant, body, &order(0.0), dt);
        let mut turned = (0.0, 0.0);
        while drive.t < end_s {
            let before = *drive.report();
            let old = motion.wheels().wheel_speeds(&drive.body.twist);
            drive.coast(&push(drive.t));
            let new = motion.wheels().wheel_speeds(&drive.body.twist);
            // Exact: the acceleration is constant over the tick.
            turned.0 += dt * (old.right + new.right) / 2.0;
            turned.1 += dt * (old.left + new.left) / 2.0;
            let count = |angle: f64| (angle * counts / std::f64::consts::TAU).floor() as i32;
            let found = monitor.check(&DetectorInputs {
                dt_us: period_us,
                counts: Some(WheelCounts {
                    right: count(turned.0),
                    left: count(turned.1),
                }),
                measured: drive.body.measured(),
                command: before.command,
                torques: Some(before.torques),
                ..DetectorInputs::default()
            });
            let list: Vec<_> = found.iter().collect();
            assert!(
                list.is_empty(),
                "{name}, {counts} counts, {} s: {list:?}",
                drive.t
            );
            let task = order(drive.t);
            drive.take(&task, &drive.body.measured());
        }
    }
}

fn none(_: f64) -> Wrench<f64> {
    Wrench::default()
}

/// The paper's line and curve from its offset, and faster ones; true masses from 0.7 to 1.5 of the stated.
#[test]
fn following_is_quiet_also_with_another_mass() {
    for factor in [0.7, 1.0, 1.5] {
        let plant = Base {
            mass: factor * Base::STANDARD.mass,
            inertia: factor * Base::STANDARD.inertia,
            ..Base::STANDARD
        };
        for (v, w) in [
            (0.4, 0.0),
            (0.4, 0.15),
            (2.0, 0.5),
            (-0.4, 0.15),
            (0.0, 1.0),
        ] {
            for dt in [0.01, 0.001] {
                let body = Body::at(0.0, 0.5, 0.0);
                quiet(
                    "follow",
                    (Base::STANDARD, plant),
                    body,
                    (dt, 12.0),
                    none,
                    steady(v, w),
                );
            }
        }
    }
}

/// 50 starts of the ring, on a strong and on a weak base, whose wheels saturate.
#[test]
fn parking_is_quiet() {
    let starts: Vec<Body> = ring().into_iter().step_by(23).collect();
    assert!(starts.len() >= 50);
    on_all_cores(&starts, |body| {
        for base in [Base::STANDARD, Base::WEAK, Base::SMALL] {
            quiet("park", (base, base), *body, (0.01, 15.0), none, home());
        }
    });
}

/// Held back at the wheels' limit, pushed while parked, pushed aside: up to 30 N, a tenth of the weight,
/// in the middle or at one wheel.
#[test]
fn saturation_and_pushes_are_quiet() {
    let feeble = {
        let mut base = Base::STANDARD;
        base.limits.wheel_torque_nm = 0.5;
        base
    };
    let held = |t: f64| Wrench {
        force: if (4.0..8.0).contains(&t) { -12.0 } else { 0.0 },
        moment: 0.0,
    };
    let start = Body::default();
    quiet(
        "feeble",
        (feeble, feeble),
        Body::at(0.0, 0.5, 0.0),
        (0.01, 20.0),
        none,
        steady(1.0, 0.0),
    );
    let base = Base::STANDARD;
    quiet(
        "held",
        (base, base),
        start,
        (0.01, 20.0),
        held,
        steady(1.0, 0.0),
    );
    for force in [-30.0, 30.0] {
        let pushed = move |t: f64| Wrench {
            force: if (5.0..6.0).contains(&t) { force } else { 0.0 },
            moment: if (8.0..9.0).contains(&t) {
                0.25 * force
            } else {
                0.0
            },
        };
        quiet("pushed", (base, base), start, (0.01, 15.0), pushed, home());
        quiet(
            "pushed",
            (base, base),
            start,
            (0.01, 15.0),
            pushed,
            steady(0.4, 0.15),
        );
    }
}
