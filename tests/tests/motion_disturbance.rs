//! A constant force and moment that no parameter knows of: parked without error, followed without lag.

use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::{Outcome, Task, ValidMotionParams};
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use controller_core::types::{Pose, WheelTorques, Wrench};
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Drive, Order, home, ring, steady};
use tests::motion_tracking::Exact;
use tests::stated::{At, Stated};
use tests::tolerance::ARRIVED;

const BASE: Base = Base::STANDARD;

/// A tenth of the largest force and moment: each alone and both, either sign.
fn pushes<T: Scalar>(motion: &ValidMotionParams<T>) -> Vec<Wrench<f64>> {
    let (force, moment) = (
        0.1 * motion.largest_force().to_f64(),
        0.1 * motion.largest_moment().to_f64(),
    );
    let mut pushes = Vec::new();
    for f in [-1.0, 0.0, 1.0] {
        for n in [-1.0, 0.0, 1.0] {
            if (f, n) != (0.0, 0.0) {
                pushes.push(Wrench {
                    force: f * force,
                    moment: n * moment,
                });
            }
        }
    }
    pushes
}

/// What many runs came to.
struct Left {
    runs: f64,
    /// Largest distance \[mm\].
    far: f64,
    /// Largest heading error \[mrad\].
    turned: f64,
    retries: f64,
}

/// A row of the table of disturbances in `docs/motion.md`, for two sets of runs.
fn state(label: &str, a: &Left, b: &Left) {
    let row = At::Row("8. Disturbance estimate", label);
    let retries = a.retries.max(b.retries);
    Stated::of("docs/motion.md").exactly(
        row,
        &[a.runs, b.runs, a.far, b.far, a.turned, b.turned, retries],
    );
}

/// Parks from every `nth` start of the ring; the largest distance and heading error left, and retries.
fn parks<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    base: Base,
    nth: usize,
    dt: f64,
    end_s: f64,
) -> Left {
    let motion: ValidMotionParams<T> = base.params::<T, M>().validate().expect("valid");
    let cases: Vec<(Body, Wrench<f64>)> = ring()
        .into_iter()
        .step_by(nth)
        .flat_map(|body| pushes(&motion).into_iter().map(move |push| (body, push)))
        .collect();
    let left = on_all_cores(&cases, |(body, push)| {
        let mut drive = Drive::<T, M, U>::start(&motion, base, *body, &home()(0.0), dt);
        while drive.t < end_s {
            drive.coast(push);
            drive.take(&home()(0.0), &drive.body.measured());
        }
        let error = drive.error(&home()(0.0));
        let report = drive.report();
        let parked = report.outcome == Outcome::Parked;
        if !parked {
            println!("{body:?} {push:?}: {error:?} {:?}", report);
        }
        (
            error.x.hypot(error.y),
            error.theta.abs(),
            report.retries,
            parked,
        )
    });
    let (mut far, mut turned, mut retries) = (0.0_f64, 0.0_f64, 0);
    for (distance, heading, tries, parked) in &left {
        assert!(parked);
        far = far.max(*distance);
        turned = turned.max(*heading);
        retries = retries.max(*tries);
    }
    println!(
        "{} runs, {dt} s: at most {:.3} mm, {:.3} mrad left, {retries} retries",
        left.len(),
        1e3 * far,
        1e3 * turned
    );
    assert!(far < ARRIVED && turned < ARRIVED);
    Left {
        runs: left.len() as f64,
        far: 1e3 * far,
        turned: 1e3 * turned,
        retries: f64::from(retries),
    }
}

#[test]
fn constant_push_leaves_nothing_when_parked() {
    let double = parks::<f64, Libm, ExactMean>(BASE, 13, 0.01, 25.0);
    let single = parks::<f32, Single, RationalMean>(BASE, 13, 0.01, 25.0);
    state(
        "ring, 10 % force (30 N), moment (7.5 N m), both, either sign; 10 ms, f64 / f32",
        &double,
        &single,
    );
    // The worst of all rows, which other bases do not reach (their row has its own figures).
    Stated::of("README.md").at_most(
        At::Phrase("10 % of the largest force or moment leaves # mm"),
        &[double.far.max(single.far)],
    );
}

#[test]
fn constant_push_leaves_nothing_at_1_ms() {
    let double = parks::<f64, Libm, ExactMean>(BASE, 97, 0.001, 25.0);
    let single = parks::<f32, Single, RationalMean>(BASE, 97, 0.001, 25.0);
    state("the same at 1 ms, f64 / f32", &double, &single);
}

#[test]
fn constant_push_leaves_nothing_on_other_bases() {
    let weak = parks::<f64, Libm, ExactMean>(Base::WEAK, 29, 0.01, 90.0);
    let small = parks::<f64, Libm, ExactMean>(Base::SMALL, 29, 0.01, 25.0);
    let row = At::Row("8. Disturbance estimate", "weak base and 1 kg");
    Stated::of("docs/motion.md").exactly(
        row,
        &[
            weak.runs,
            small.runs,
            weak.far.max(small.far),
            weak.turned.max(small.turned),
            weak.retries.max(small.retries),
        ],
    );
}

/// On a line at constant speed the lag goes as well; without the estimate it is F/(κ₁ m k₁) = 0.28 m.
#[test]
fn constant_push_leaves_no_lag_on_a_line() {
    let motion = BASE.exact().validate().expect("valid");
    let mut runs = 0;
    for v in [-0.4, 0.2, 0.4, 1.0] {
        for push in pushes(&motion) {
            runs += 1;
            let line = steady(v, 0.0);
            let mut drive = Exact::start(&motion, BASE, Body::at(0.0, 0.1, 0.0), &line(0.0), 0.01);
            while drive.t < 25.0 {
                drive.coast(&push);
                drive.take(&line(drive.t), &drive.body.measured());
            }
            let error = drive.error(&line(drive.t));
            assert!(
                error.x.abs() < ARRIVED && error.y.abs() < ARRIVED,
                "{v} m/s, {push:?}: {error:?}"
            );
        }
    }
    let label = "line at −0.4, 0.2, 0.4, 1 m/s, the same pushes: e_x and e_y after 25 s";
    let row = At::Row("8. Disturbance estimate", label);
    Stated::of("docs/motion.md").exactly(row, &[f64::from(runs), 1e3 * ARRIVED]);
}

/// Beyond the bound the estimate stays at it and says so; the lag that is left is that of the rest.
#[test]
fn bound_holds_and_is_told() {
    let motion = BASE.exact().validate().expect("valid");
    let bound = motion.disturbance_bound().force;
    let line = steady(0.4, 0.0);
    let mut drive = Exact::start(&motion, BASE, Body::default(), &line(0.0), 0.01);
    let push = Wrench {
        force: -1.5 * bound,
        moment: 0.0,
    };
    let mut reported = 0;
    while drive.t < 20.0 {
        drive.coast(&push);
        let report = drive.take(&line(drive.t), &drive.body.measured());
        assert!(report.disturbance.force.abs() <= bound);
        reported += u32::from(report.limited.disturbance);
    }
    assert!(reported > 1500, "{reported}");
    // The push ends: nothing is wound up, the estimate leaves its bound at once and goes.
    drive.advance(line);
    drive.advance(line);
    assert!(drive.report().disturbance.force > -bound);
    while drive.t < 24.0 {
        drive.advance(line);
    }
    assert!(drive.report().disturbance.force.abs() < 0.01 * bound);
    assert!(drive.error(&line(drive.t)).x.abs() < 0.1);
}

/// A push at the bound that ends while the robot is parked: it surges, by less than the estimate's momentum over the
/// speed loop, D/(m κ₁ ω) = 17 cm, and parks again.
#[test]
fn push_that_ends_is_a_bounded_surge() {
    let motion = BASE.exact().validate().expect("valid");
    let (gains, bound) = (motion.gains(), motion.disturbance_bound().force);
    let most = bound / (BASE.mass * gains.speed_loop * gains.disturbance);
    let mut drive = Exact::start(&motion, BASE, Body::at(-0.5, 0.0, 0.0), &home()(0.0), 0.01);
    let mut surge = 0.0_f64;
    while drive.t < 60.0 {
        let push = if drive.t < 30.0 { -0.99 * bound } else { 0.0 };
        drive.coast(&Wrench {
            force: push,
            moment: 0.0,
        });
        drive.take(&home()(0.0), &drive.body.measured());
        if drive.t > 30.0 {
            let error = drive.error(&home()(0.0));
            surge = surge.max(error.x.hypot(error.y));
        } else if drive.t > 29.0 {
            assert_eq!(drive.report().outcome, Outcome::Parked);
        }
    }
    println!(
        "surge {:.1} mm of at most {:.1} mm",
        1e3 * surge,
        1e3 * most
    );
    assert!(surge < most);
    Stated::of("docs/motion.md").exactly(
        At::Phrase("D/(m κ₁ ω), # cm for the base above; parked there against a push at the bound that ends, # cm"),
        &[1e2 * most, 1e2 * surge],
    );
    assert_eq!(drive.report().outcome, Outcome::Parked);
}

/// Off means off: the bits of the estimate never leave 0.
#[test]
fn zero_bandwidth_estimates_nothing() {
    let mut params = BASE.exact();
    params.gains.disturbance = 0.0;
    let motion = params.validate().expect("valid");
    let gains = *motion.gains();
    let mut drive = Exact::start(&motion, BASE, Body::at(-0.5, 0.1, 0.2), &home()(0.0), 0.01);
    while drive.t < 10.0 {
        drive.coast(&Wrench {
            force: 5.0,
            moment: 0.0,
        });
        let report = drive.take(&home()(0.0), &drive.body.measured());
        assert_eq!(report.disturbance, Wrench::default());
    }
    // What the velocity loop alone leaves: the speed F/(κ₁ m) is asked of a neuron with bound B by k₁ e_x.
    let left = drive.error(&home()(0.0)).x.abs();
    let asked = 5.0 / (gains.speed_loop * BASE.mass);
    let alone = asked / gains.longitudinal;
    let expected = alone / (1.0 - asked / gains.longitudinal_bound);
    assert!(
        (left / expected - 1.0).abs() < 0.02,
        "{left} for {expected}"
    );
    Stated::of("docs/motion.md").exactly(
        At::Phrase("position error (1 N: # mm)"),
        &[1e3 * alone / 5.0],
    );
}

/// A motor layer that gives half of what is asked and says so is no disturbance; one that keeps silent is.
#[test]
fn what_is_really_exerted_can_be_told() {
    let motion = BASE.exact().validate().expect("valid");
    let order: Order = Task::Park(Pose::new(2.0, 0.0, 0.0));
    for (informed, most) in [(true, 1e-9), (false, f64::INFINITY)] {
        let mut drive = Exact::start(&motion, BASE, Body::default(), &order, 0.01);
        let mut seen = 0.0_f64;
        while drive.t < 1.0 {
            let asked = drive.report().torques;
            let half = WheelTorques {
                right: asked.right / 2.0,
                left: asked.left / 2.0,
            };
            let applied = drive.applied();
            if informed {
                drive.controller.note_applied(&half).expect("finite");
            }
            drive.coast(&Wrench {
                force: -applied.force / 2.0,
                moment: -applied.moment / 2.0,
            });
            let report = drive.take(&order, &drive.body.measured());
            seen = seen.max(report.disturbance.force.abs());
        }
        println!("informed {informed}: estimate up to {seen:.2} N");
        assert!(seen <= most);
        assert!(informed || seen > 1.0);
    }
    let mut drive = Exact::start(&motion, BASE, Body::default(), &order, 0.01);
    let before = drive.controller;
    let wild = WheelTorques {
        right: f64::NAN,
        left: 0.0,
    };
    assert!(drive.controller.note_applied(&wild).is_err());
    assert_eq!(drive.controller, before);
}

/// A brake holds the wheels for a second: the estimate rests.
#[test]
fn estimate_rests_while_the_wheels_are_not_driven() {
    let motion = BASE.exact().validate().expect("valid");
    let order: Order = Task::Park(Pose::new(2.0, 0.0, 0.0));
    let mut drive = Exact::start(&motion, BASE, Body::default(), &order, 0.01);
    for _ in 0..100 {
        drive.controller.note_not_driven();
        let report = drive.take(&order, &Body::default().measured());
        assert_eq!(report.disturbance, Wrench::default());
    }
}
