//! Dry friction: arrives within a millimetre, and then neither torque nor robot hunts.

use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::{AtRest, Outcome, ValidMotionParams};
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use controller_core::types::Wrench;
use tests::motion_base::{Base, Body};
use tests::motion_friction::{AxisFriction, Friction};
use tests::motion_loop::ring;
use tests::motion_rest::{Worst, rest_all};
use tests::motion_wheel_friction::WheelFriction;
use tests::stated::{At, Stated};
use tests::tolerance::ARRIVED;

/// The worst of several sets of runs, and how many runs.
#[derive(Clone, Copy, Default)]
struct Sum(Worst, usize);

impl Sum {
    fn add(&mut self, more: &Worst, runs: usize) {
        let Self(all, count) = self;
        all.left = (all.left.0.max(more.left.0), all.left.1.max(more.left.1));
        all.parked_s = all.parked_s.max(more.parked_s);
        for (all, more) in all.retried.iter_mut().zip(more.retried) {
            *all += more;
        }
        all.hunting = (
            all.hunting.0.max(more.hunting.0),
            all.hunting.1.max(more.hunting.1),
        );
        all.lost += more.lost;
        *count += runs;
    }

    /// A row of the table of disturbances in `docs/motion.md`: runs, those of them that did not park if any may, what
    /// the others left, and retries.
    fn state(&self, label: &str, may_lose: bool) {
        let Self(all, count) = self;
        let mut figures = vec![*count as f64];
        if may_lose {
            figures.push(f64::from(all.lost));
        }
        figures.extend([1e3 * all.left.0, 1e3 * all.left.1, all.parked_s]);
        let [_, once, twice] = all.retried.map(f64::from);
        match (once, twice) {
            (0.0, 0.0) => figures.push(0.0),
            (_, 0.0) => figures.extend([1.0, once]),
            _ => figures.extend([1.0, once, 2.0, twice]),
        }
        let row = At::Row("8. Disturbance estimate", label);
        Stated::of("docs/motion.md").exactly(row, &figures);
    }
}

/// Every `nth` start of the ring.
fn starts(nth: usize) -> Vec<Body> {
    ring().into_iter().step_by(nth).collect()
}

fn motion<T: Scalar, M: Maths<T>>(base: Base, at_rest: AtRest) -> ValidMotionParams<T> {
    let mut params = base.params::<T, M>();
    params.arrival.at_rest = at_rest;
    params.validate().expect("valid")
}

/// Way in ten seconds at rest that is no movement \[m\]: a fiftieth of the tolerance.
const CREPT: f64 = 1e-5;

/// Parked within 1 mm, and held or let go without hunting.
fn nothing_is_left<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    name: &str,
    (base, friction): (Base, &impl Friction),
    (nth, dt): (usize, f64),
    sums: &mut [Sum; 2],
) {
    for (at_rest, sum) in [AtRest::Hold, AtRest::Release].into_iter().zip(sums) {
        let name = format!("{name}, {} bytes, {dt} s, {at_rest:?}", size_of::<T>());
        let motion = motion::<T, M>(base, at_rest);
        let against = (base, friction);
        let (all, runs) = rest_all::<T, M, U>(&name, &motion, against, &starts(nth), (dt, 60.0));
        assert_eq!(all.lost, 0, "{name}");
        assert!(all.left.0 < ARRIVED && all.left.1 < ARRIVED, "{name}");
        // The stop of the last roll, with its counter-torque; from then on nothing.
        assert!(all.hunting.0 <= 2 && all.hunting.1 < 1.0, "{name}");
        // Friction that the estimate makes up for no longer stops the robot: what is left of its speed decays, down to
        // the rounding of single precision.
        assert!(all.crept < CREPT, "{name}: {}", all.crept);
        sum.add(&all, runs.len());
        if at_rest == AtRest::Release {
            assert!(
                runs.iter().all(|run| run.last == Wrench::default()),
                "{name}"
            );
        }
    }
}

/// Both axes like blocks on a table, every fifth start of the ring and some in single precision and at 5 ms.
#[test]
fn dry_friction_leaves_nothing_and_nothing_hunts() {
    let table = (Base::STANDARD, &AxisFriction::WHEELS);
    let mut sums = [Sum::default(); 2];
    nothing_is_left::<f64, Libm, ExactMean>("axes", table, (5, 0.01), &mut sums);
    nothing_is_left::<f32, Single, RationalMean>("axes", table, (11, 0.01), &mut sums);
    nothing_is_left::<f64, Libm, ExactMean>("axes", table, (17, 0.005), &mut sums);
    nothing_is_left::<f32, Single, RationalMean>("axes", table, (17, 0.005), &mut sums);
    let held = "dry friction per axis, 5 N (1.25 N m) to break away, 4 N (1 N m) sliding; held, 10 and 5 ms, f64 and f32";
    sums[0].state(held, false);
    sums[1].state("the same, released", false);
}

/// Wheels that stand and slide each by itself, with a 60th of their force to break away (5 N in all on the large base), and a 20th on the
/// small one, where sliding friction alone then turns it at 5 rad/s². One wheel may stand while the other creeps: many runs need a retry.
/// Of 1,728 starts of the small base 2 end out of tolerance with a 60th, which of them is chance: one of those here may. With a 20th 31
/// of 89 end out of tolerance, and no more (15 with neurons of 4 k₄ in place of 7.68 k₄, whose bearing is damped too little:
/// `docs/motion.md`, section 11). Nobody moves in the end.
#[test]
fn dry_friction_of_each_wheel_is_parked_or_told() {
    let (large, small) = ((Base::STANDARD, 1.0 / 60.0), (Base::SMALL, 1.0 / 60.0));
    let mut sum = Sum::default();
    on_wheels::<f64, Libm, ExactMean>("wheels, 30 kg", large, (13, 0.01), 0.0, &mut sum);
    on_wheels::<f32, Single, RationalMean>("wheels, 30 kg", large, (17, 0.01), 0.0, &mut sum);
    on_wheels::<f32, Single, RationalMean>("wheels, 30 kg", large, (29, 0.005), 0.0, &mut sum);
    let mut latest = sum.0.hunting.1;
    sum.state("dry friction per wheel, 2.5 N to break away, 2 N sliding; held, the same periods and precisions", false);
    let mut sum = Sum::default();
    on_wheels::<f64, Libm, ExactMean>("wheels, 1 kg", small, (13, 0.01), 0.02, &mut sum);
    on_wheels::<f32, Single, RationalMean>("wheels, 1 kg", small, (17, 0.005), 0.02, &mut sum);
    latest = latest.max(sum.0.hunting.1);
    sum.state("the same on 1 kg, 0.02 N to break away", true);
    let mut sum = Sum::default();
    let harder = (Base::SMALL, 0.05);
    on_wheels::<f64, Libm, ExactMean>("wheels, 1 kg, 5 %", harder, (13, 0.01), 0.35, &mut sum);
    latest = latest.max(sum.0.hunting.1);
    sum.state("0.06 N to break away", true);
    // Those with friction per axis are done sooner, and are held to 1 s.
    Stated::of("docs/motion.md").exactly(
        At::Phrase("more than twice, none later than # s"),
        &[latest],
    );
}

/// At most a share `gives_up` of the runs does not park, and says so.
fn on_wheels<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    name: &str,
    (base, share): (Base, f64),
    (nth, dt): (usize, f64),
    gives_up: f64,
    sum: &mut Sum,
) {
    let name = format!("{name}, {} bytes, {dt} s", size_of::<T>());
    let wheels = (base, &WheelFriction::of(&base, share));
    let motion = motion::<T, M>(base, AtRest::Hold);
    let (all, runs) = rest_all::<T, M, U>(&name, &motion, wheels, &starts(nth), (dt, 90.0));
    assert!(all.left.0 < ARRIVED && all.left.1 < ARRIVED, "{name}");
    assert!(
        f64::from(all.lost) <= gives_up * runs.len() as f64,
        "{name}"
    );
    sum.add(&all, runs.len());
    // One wheel may come to rest after the other.
    assert!(all.hunting.0 <= 2 && all.hunting.1 < 1.25, "{name}");
    for run in &runs {
        assert!(matches!(
            run.outcome,
            Outcome::Parked | Outcome::OutOfTolerance
        ));
        // Who gave up moving may still come to rest.
        assert!(run.crept < CREPT, "{run:?}");
    }
}

/// Without the estimate friction keeps the robot off; that is reported, after two retries, and the robot rests.
#[test]
fn without_the_estimate_friction_is_told() {
    let mut params = Base::STANDARD.exact();
    params.gains.disturbance = 0.0;
    let motion = params.validate().expect("valid");
    let table = (Base::STANDARD, &AxisFriction::WHEELS);
    let (_, runs) =
        rest_all::<f64, Libm, ExactMean>("no estimate", &motion, table, &starts(31), (0.01, 90.0));
    for run in &runs {
        assert!(
            matches!(run.outcome, Outcome::OutOfTolerance | Outcome::Parked),
            "{run:?}"
        );
        assert_eq!(run.crept, 0.0);
    }
    let gave_up = runs
        .iter()
        .filter(|run| run.outcome == Outcome::OutOfTolerance)
        .count();
    println!("{gave_up} of {} out of tolerance", runs.len());
    assert!(gave_up > 0);
}
