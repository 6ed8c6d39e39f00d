//! Any start, any direction, any speed.

use std::f64::consts::PI;

use controller_core::maths::Libm;
use controller_core::motion::Task;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Order, steady};
use tests::motion_tracking::{Tracking, follow};
use tests::random::Random;
use tests::stated::{At, Stated};
use tests::tolerance::{MOTION_SETTLED_LATE, START};

fn run(base: Base, body: Body, end_s: f64, order: impl Fn(f64) -> Order) -> Tracking {
    let motion = base.exact().validate().expect("valid");
    follow(&motion, base, body, 0.01, end_s, order)
}

/// Checks that a run ends on its reference and started without torque; when it got there \[s\].
fn arrives(name: &str, run: &Tracking, within_s: f64) -> f64 {
    println!(
        "{name}: {:.2} s, N {:.1}, w {:.2}, left {:.2e} m",
        run.settled_s, run.moment, run.turn_rate, run.late
    );
    assert!(run.settled_s < within_s, "{name}: {} s", run.settled_s);
    assert!(run.late < MOTION_SETTLED_LATE, "{name}: {} m", run.late);
    assert!(run.start.force.abs() < START, "{name}: {:?}", run.start);
    assert!(run.start.moment.abs() < START, "{name}: {:?}", run.start);
    run.settled_s
}

/// A row of the table of runs in `docs/motion.md`.
fn state(label: &str, measured: &[f64]) {
    let row = At::Row("10. What was measured", label);
    Stated::of("docs/motion.md").exactly(row, measured);
}

/// The reference goes 0.6 m to and fro: v_r = 0.3 sin t, from v_r(0) = 0 and through 0.
fn to_and_fro(t: f64) -> Order {
    let pose = Pose::new(0.3 * (1.0 - t.cos()), 0.0, 0.0);
    let (twist, accel) = (
        Twist::new(0.3 * t.sin(), 0.0),
        Accel::new(0.3 * t.cos(), 0.0),
    );
    Task::Follow(Reference::new_with::<Libm>(pose, twist, accel))
}

#[test]
fn speed_through_zero_from_rest() {
    let time_s = arrives(
        "0.3 sin t",
        &run(Base::STANDARD, Body::at(0.0, -0.05, 0.0), 30.0, to_and_fro),
        4.0,
    );
    state("v_r = 0.3 sin t, 5 cm beside", &[time_s]);
}

#[test]
fn backward_reference() {
    let body = Body::at(0.0, -0.5, 0.0);
    let straight = arrives(
        "-0.4 m/s",
        &run(Base::STANDARD, body, 30.0, steady(-0.4, 0.0)),
        6.0,
    );
    let turning = arrives(
        "-0.4 m/s, turning",
        &run(Base::STANDARD, body, 30.0, steady(-0.4, 0.3)),
        12.0,
    );
    state(
        "−0.4 m/s, 0.5 m beside; the same with 0.3 rad/s",
        &[straight, turning],
    );
}

#[test]
fn turning_in_place() {
    let body = Body::at(0.2, -0.3, 0.0);
    let times = [(0.5, 25.0), (2.0, 12.0)].map(|(w, within_s)| {
        arrives(
            "in place",
            &run(Base::STANDARD, body, 60.0, steady(0.0, w)),
            within_s,
        )
    });
    state("turning in place at 0.5 / 2 rad/s, 0.36 m off", &times);
}

/// Neither the exact half turn nor its neighbours stall.
#[test]
fn heading_at_pi() {
    let (mut slow, mut fast) = (0.0_f64, 0.0_f64);
    for theta in [PI, -PI, PI - 1e-6, PI + 1e-6, 3.0 * PI] {
        for v in [0.4, 1.0, -0.4] {
            let run = run(
                Base::STANDARD,
                Body::at(0.0, 0.0, theta),
                40.0,
                steady(v, 0.0),
            );
            let latest = if v == 1.0 { &mut fast } else { &mut slow };
            *latest = latest.max(arrives("heading pi", &run, 12.0));
        }
    }
    state(
        "heading π, −π, π ± 1e-6, 3π at ±0.4 m/s / 1 m/s",
        &[slow, fast],
    );
}

/// A reference at rest draws the robot along its heading and turns it. Sideways is parking's business: what lateral
/// error there is stays, and nothing else comes of it.
#[test]
fn reference_at_rest_does_no_harm() {
    let order = steady(0.0, 0.0);
    arrives(
        "at rest",
        &run(Base::STANDARD, Body::at(-0.3, 0.0, 0.0), 30.0, order),
        8.0,
    );
    let beside = run(Base::STANDARD, Body::at(-0.3, 0.1, 0.4), 30.0, order);
    println!("beside a reference at rest: left {:?}", beside.left);
    assert!(beside.left.x.abs() < 1e-3 && beside.left.theta.abs() < 1e-3);
    assert!(beside.late < 0.3);
}

/// Twist of the robot is taken over as it is: the first torque is none.
#[test]
fn moving_starts() {
    for (v, w) in [(1.0, 0.0), (-0.5, 0.0), (0.4, 1.5), (2.0, -1.0)] {
        let mut body = Body::at(0.1, -0.2, 0.3);
        body.twist = Twist::new(v, w);
        arrives(
            "on the move",
            &run(Base::STANDARD, body, 40.0, steady(0.6, 0.1)),
            12.0,
        );
    }
}

/// The paper's two cases from rest, and faster circles.
#[test]
fn lines_and_circles_from_rest() {
    let start = Body::at(0.0, 1.0, 0.0);
    let curve = arrives(
        "case 2",
        &run(Base::STANDARD, start, 30.0, steady(0.4, 0.15)),
        8.0,
    );
    let line = |t: f64| {
        let way = 0.4 * t * (PI / 4.0).cos();
        let pose = Pose::new(way, way, PI / 4.0);
        Task::Follow(Reference::new_with::<Libm>(
            pose,
            Twist::new(0.4, 0.0),
            Accel::default(),
        ))
    };
    let line = arrives("case 1", &run(Base::STANDARD, start, 30.0, line), 6.5);
    let beside = Body::at(0.0, -0.3, 0.0);
    let slow = arrives(
        "1 m/s, 1 rad/s",
        &run(Base::STANDARD, beside, 30.0, steady(1.0, 1.0)),
        8.0,
    );
    let fast = arrives(
        "2 m/s, 1 rad/s",
        &run(Base::STANDARD, beside, 30.0, steady(2.0, 1.0)),
        12.0,
    );
    state("case 1 / case 2 from rest, 1 m beside", &[line, curve]);
    state("circle 1 m/s, 1 rad/s / 2 m/s, 1 rad/s", &[slow, fast]);
}

/// Random poses within 2 m, any heading, against random references; from rest.
fn random_starts(base: Base, fastest: f64) -> (usize, Vec<f64>) {
    let mut random = Random(0x5EED_0004);
    let turn = 0.5 * base.limits.turn_accel.min(1.0);
    let cases: Vec<(Body, f64, f64)> = (0..300)
        .map(|_| {
            let body = Body::at(random.within(2.0), random.within(2.0), random.within(PI));
            let v = random.within(fastest);
            let v = if v.abs() < 0.1 { 0.1 } else { v };
            (body, v, random.within(turn))
        })
        .collect();
    let runs = on_all_cores(&cases, |(body, v, w)| {
        run(base, *body, 60.0, steady(*v, *w))
    });
    let on_path = runs.iter().filter(|run| run.late < 5e-3).count();
    let lost = runs.len() - on_path;
    let mut times: Vec<f64> = runs.iter().map(|run| run.settled_s).collect();
    times.sort_by(f64::total_cmp);
    (lost, times)
}

#[test]
fn none_of_300_random_starts_is_lost() {
    let (lost, times) = random_starts(Base::STANDARD, 2.0);
    println!(
        "lost {lost}, median {:.1} s, longest {:.1} s",
        times[150], times[299]
    );
    assert_eq!(lost, 0);
    state(
        "300 random starts within 2 m, any heading, up to 2 m/s: lost 0",
        &[times[150], times[299]],
    );
}

/// 10 N and 5 N m on 30 kg.
#[test]
fn none_of_300_random_starts_is_lost_on_a_weak_base() {
    let (lost, times) = random_starts(Base::WEAK, 1.0);
    println!(
        "weak: lost {lost}, median {:.1} s, longest {:.1} s",
        times[150], times[299]
    );
    assert_eq!(lost, 0);
    state(
        "the same on the weak base, up to 1 m/s: lost 0",
        &[times[150], times[299]],
    );
}
