//! Parks against dry friction, and watches whether torque or robot hunt once it stands.

use controller_core::maths::Maths;
use controller_core::motion::{Outcome, ValidMotionParams};
use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronUpdate;
use controller_core::types::Wrench;

use crate::ideal::on_all_cores;
use crate::motion_base::{Base, Body};
use crate::motion_friction::Friction;
use crate::motion_loop::{Drive, home};

/// What a run came to.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// At the end.
    pub outcome: Outcome,
    /// Distance and heading error left \[m, rad\].
    pub left: (f64, f64),
    /// New approaches.
    pub retries: u8,
    /// When it was parked for good \[s\].
    pub parked_s: f64,
    /// After it was parked for good: most sign changes among force, moment, speed and turn rate.
    pub hunting: u32,
    /// The last of them after the robot was parked \[s\].
    pub hunting_s: f64,
    /// Way in the last ten seconds \[m\].
    pub crept: f64,
    /// Wrench at the end.
    pub last: Wrench<f64>,
}

/// Less is rest \[m/s, rad/s\]: a hundredth of a millimetre in ten seconds. Where what is held is sliding friction to the last bit,
/// rounding turns a base by 1e-11 rad/s to and fro.
const LEAST_SPEED: f64 = 1e-6;

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

/// Parks at the origin for `end_s`, of which the last ten seconds are to be rest.
pub fn rest<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    motion: &ValidMotionParams<T>,
    base: Base,
    friction: &impl Friction,
    body: &Body,
    (dt, end_s): (f64, f64),
) -> Seen {
    let order = home()(0.0);
    let mut drive = Drive::<T, M, U>::start(motion, base, *body, &order, dt);
    // A torque of a thousandth of the breakaway is no torque.
    let least = friction.breakaway();
    let (mut signs, mut parked_s, mut crept) = ([Signs::default(); 4], 0.0, 0.0);
    while drive.t < end_s {
        let before = drive.body.pose;
        drive.coast_against(friction);
        drive.take(&order, &drive.body.measured());
        if drive.report().outcome != Outcome::Parked {
            (signs, parked_s) = ([Signs::default(); 4], drive.t);
        }
        let (applied, twist) = (drive.applied(), drive.body.twist);
        let felt = |value: f64, least: f64| {
            if value.abs() < 1e-3 * least {
                0.0
            } else {
                value
            }
        };
        signs[0].see(drive.t, felt(applied.force, least.force));
        signs[1].see(drive.t, felt(applied.moment, least.moment));
        signs[2].see(drive.t, felt(twist.linear, 1e3 * LEAST_SPEED));
        signs[3].see(drive.t, felt(twist.angular, 1e3 * LEAST_SPEED));
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

/// The worst of many runs that parked, and how many did not.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    /// Distance and heading error left \[m, rad\].
    pub left: (f64, f64),
    /// The last was parked by then \[s\].
    pub parked_s: f64,
    /// Runs with 0, 1 and 2 retries.
    pub retried: [u32; 3],
    /// Sign changes after it was parked, and the last of them after that \[s\].
    pub hunting: (u32, f64),
    /// Way in the last ten seconds \[m\].
    pub crept: f64,
    /// Not parked.
    pub lost: u32,
}

/// [`rest`] from every start, on all cores; one line is printed.
pub fn rest_all<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    name: &str,
    motion: &ValidMotionParams<T>,
    (base, friction): (Base, &impl Friction),
    starts: &[Body],
    times: (f64, f64),
) -> (Worst, Vec<Seen>) {
    let runs = on_all_cores(starts, |body| {
        rest::<T, M, U>(motion, base, friction, body, times)
    });
    let mut all = Worst::default();
    for (run, start) in runs.iter().zip(starts) {
        if run.outcome != Outcome::Parked {
            println!(
                "{:?} {:?}: {:?}, {:?}",
                start.pose, run.outcome, run.left, run.retries
            );
            all.lost += 1;
            continue;
        }
        all.left = (all.left.0.max(run.left.0), all.left.1.max(run.left.1));
        all.parked_s = all.parked_s.max(run.parked_s);
        all.retried[usize::from(run.retries)] += 1;
        all.hunting = (
            all.hunting.0.max(run.hunting),
            all.hunting.1.max(run.hunting_s),
        );
        all.crept = all.crept.max(run.crept);
    }
    println!(
        "{name}: {} runs, {:.3} mm, {:.3} mrad, parked by {:.1} s, retries {:?}, {} changes until {:.2} s, lost {}",
        runs.len(),
        1e3 * all.left.0,
        1e3 * all.left.1,
        all.parked_s,
        all.retried,
        all.hunting.0,
        all.hunting.1,
        all.lost
    );
    (all, runs)
}
