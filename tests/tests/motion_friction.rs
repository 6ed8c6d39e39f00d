//! Dry friction: arrives within a millimetre, and then neither torque nor robot hunts.

use controller_core::motion::{AtRest, Outcome};
use controller_core::types::Wrench;
use tests::motion_base::{Base, Body};
use tests::motion_friction::Friction;
use tests::motion_loop::{both_cores, home, ring};
use tests::motion_tracking::Exact;
use tests::tolerance::ARRIVED;

const BASE: Base = Base::STANDARD;

/// What a run came to.
#[derive(Clone, Copy, Debug)]
struct Seen {
    outcome: Outcome,
    left: (f64, f64),
    retries: u8,
    parked_s: f64,
    /// After it was parked for good: most sign changes among force, moment, speed and turn rate.
    hunting: u32,
    /// The last of them after the robot was parked \[s\].
    hunting_s: f64,
    /// Way in the last ten seconds \[m\].
    crept: f64,
    last: Wrench<f64>,
}

/// Last sign of a signal, how often it changed, and when last.
#[derive(Clone, Copy, Default)]
struct Signs(f64, u32, f64);

impl Signs {
    fn see(&mut self, t: f64, value: f64) {
        if value != 0.0 {
            if self.0 * value < 0.0 {
                self.1 += 1;
                self.2 = t;
            }
            self.0 = value.signum();
        }
    }
}

fn park(body: &Body, at_rest: AtRest, disturbance: bool, end_s: f64) -> Seen {
    let mut params = BASE.exact();
    params.arrival.at_rest = at_rest;
    if !disturbance {
        params.gains.disturbance = 0.0;
    }
    let motion = params.validate().expect("valid");
    let order = home()(0.0);
    let mut drive = Exact::start(&motion, BASE, *body, &order, 0.01);
    let (mut signs, mut parked_s, mut crept) = ([Signs::default(); 4], 0.0, 0.0);
    while drive.t < end_s {
        let before = drive.body.pose;
        drive.coast_against(&Friction::WHEELS);
        drive.take(&order, &drive.body.measured());
        if drive.report().outcome != Outcome::Parked {
            (signs, parked_s) = ([Signs::default(); 4], drive.t);
        }
        let (applied, twist) = (drive.applied(), drive.body.twist);
        // A torque of a thousandth of the breakaway is no torque.
        let felt = |value: f64, least: f64| if value.abs() < least { 0.0 } else { value };
        signs[0].see(drive.t, felt(applied.force, 5e-3));
        signs[1].see(drive.t, felt(applied.moment, 1e-3));
        signs[2].see(drive.t, twist.linear);
        signs[3].see(drive.t, twist.angular);
        if drive.t > end_s - 10.0 {
            let pose = drive.body.pose;
            crept += (pose.x - before.x).hypot(pose.y - before.y);
        }
    }
    let error = drive.error(&order);
    Seen {
        outcome: drive.report().outcome,
        left: (error.x.hypot(error.y), error.theta.abs()),
        retries: drive.report().retries,
        parked_s,
        hunting: signs.iter().map(|signs| signs.1).max().unwrap_or(0),
        hunting_s: signs
            .iter()
            .fold(0.0, |late: f64, signs| late.max(signs.2 - parked_s)),
        crept,
        last: drive.applied(),
    }
}

/// Every start of the ring's third part: parked within 1 mm, held without a change of sign.
#[test]
fn dry_friction_leaves_nothing_and_nothing_hunts() {
    let starts: Vec<Body> = ring().into_iter().step_by(5).collect();
    for at_rest in [AtRest::Hold, AtRest::Release] {
        let runs = both_cores(&starts, |body| park(body, at_rest, true, 60.0));
        let mut retried = [0; 3];
        let (mut far, mut turned, mut late, mut hunting, mut hunting_s, mut lost) =
            (0.0_f64, 0.0_f64, 0.0_f64, 0, 0.0_f64, 0);
        for (run, start) in runs.iter().zip(&starts) {
            if run.outcome != Outcome::Parked {
                println!("{start:?}: {run:?}");
                lost += 1;
                continue;
            }
            retried[usize::from(run.retries)] += 1;
            far = far.max(run.left.0);
            turned = turned.max(run.left.1);
            late = late.max(run.parked_s);
            hunting = hunting.max(run.hunting);
            hunting_s = hunting_s.max(run.hunting_s);
            assert_eq!(run.crept, 0.0, "{run:?}");
            if at_rest == AtRest::Release {
                assert_eq!(run.last, Wrench::default(), "{run:?}");
            }
        }
        println!(
            "{at_rest:?}: {} runs, {:.3} mm, {:.3} mrad, parked by {late:.1} s, retries {retried:?}, \
             {hunting} changes until {hunting_s:.2} s, lost {lost}",
            runs.len(),
            1e3 * far,
            1e3 * turned
        );
        assert_eq!(lost, 0);
        assert!(far < ARRIVED && turned < ARRIVED);
        // The stop of the last roll, with its counter-torque; from then on nothing.
        assert!(hunting <= 2 && hunting_s < 1.0);
    }
}

/// Without the estimate friction keeps the robot off; that is told, after two retries, and the robot rests.
#[test]
fn without_the_estimate_friction_is_told() {
    let starts: Vec<Body> = ring().into_iter().step_by(31).collect();
    let runs = both_cores(&starts, |body| park(body, AtRest::Hold, false, 90.0));
    for run in &runs {
        assert!(
            matches!(run.outcome, Outcome::OutOfTolerance | Outcome::Parked),
            "{run:?}"
        );
        assert_eq!(run.crept, 0.0);
    }
    let told = runs
        .iter()
        .filter(|run| run.outcome == Outcome::OutOfTolerance)
        .count();
    println!("{told} of {} out of tolerance", runs.len());
    assert!(told > 0);
}
