//! Figures of parking, one run and many.

use controller_core::maths::Maths;
use controller_core::motion::{Outcome, ValidMotionParams};
use controller_core::pose_error::PoseError;
use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronUpdate;
use controller_core::types::Wrench;

use crate::ideal::on_all_cores;
use crate::motion_base::{Base, Body};
use crate::motion_loop::{Drive, home};

/// Moments below this do not count as turning \[N m\].
const FELT: f64 = 1e-3;

/// What a parking run came to. The largest, where it stands for many.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parking {
    /// From when on within 1 cm and 0.02 rad \[s\].
    pub near_s: f64,
    /// From when on within 1 mm and 1 mrad \[s\].
    pub arrived_s: f64,
    /// Sign changes of the moment.
    pub changes: u32,
    /// The last of them after arrival \[s\]; below 0 before.
    pub late_s: f64,
    /// What is left, absolute.
    pub left: PoseError<f64>,
    /// Largest force \[N\].
    pub force: f64,
    /// Largest moment \[N m\].
    pub moment: f64,
    /// Largest change of wheel torque in a tick over its time \[N m/s\].
    pub torque_rate: f64,
    /// Change of force and moment in the first tick.
    pub first: (f64, f64),
    /// Wrench at the very start.
    pub start: (f64, f64),
    /// Runs that are not parked at the end.
    pub lost: u32,
}

/// Collects the figures tick by tick.
#[derive(Clone, Copy, Debug)]
pub struct ParkingObserver {
    figures: Parking,
    sign: f64,
    changed_s: f64,
    last: Wrench<f64>,
    ticks: u32,
}

impl ParkingObserver {
    /// Before the first tick; `wrench` is what the start asks for.
    pub fn start(wrench: &Wrench<f64>) -> Self {
        let figures = Parking {
            start: (wrench.force.abs(), wrench.moment.abs()),
            ..Parking::default()
        };
        Self {
            figures,
            sign: 0.0,
            changed_s: f64::NEG_INFINITY,
            last: *wrench,
            ticks: 0,
        }
    }

    /// At time `t`, `dt` after the last.
    pub fn tick(&mut self, t: f64, dt: f64, error: &PoseError<f64>, wrench: &Wrench<f64>) {
        let seen = &mut self.figures;
        let distance = error.x.hypot(error.y);
        if distance > 0.01 || error.theta.abs() > 0.02 {
            seen.near_s = t;
        }
        if distance > 1e-3 || error.theta.abs() > 1e-3 {
            seen.arrived_s = t;
        }
        if wrench.moment.abs() > FELT {
            let sign = wrench.moment.signum();
            if self.sign * sign < 0.0 {
                seen.changes += 1;
                self.changed_s = t;
            }
            self.sign = sign;
        }
        let step = (
            wrench.force - self.last.force,
            wrench.moment - self.last.moment,
        );
        if self.ticks == 0 {
            seen.first = (step.0.abs(), step.1.abs());
        }
        seen.force = seen.force.max(wrench.force.abs());
        seen.moment = seen.moment.max(wrench.moment.abs());
        seen.torque_rate = seen.torque_rate.max(Base::wheel_norm(step.0, step.1) / dt);
        seen.left = *error;
        self.last = *wrench;
        self.ticks += 1;
    }

    /// The figures.
    pub fn end(mut self, parked: bool) -> Parking {
        let seen = &mut self.figures;
        seen.late_s = self.changed_s - seen.arrived_s;
        seen.left = PoseError {
            x: seen.left.x.abs(),
            y: seen.left.y.abs(),
            theta: seen.left.theta.abs(),
        };
        seen.lost = u32::from(!parked);
        self.figures
    }
}

/// Parks at the origin for `end_s`.
pub fn park<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    motion: &ValidMotionParams<T>,
    plant: Base,
    body: Body,
    dt: f64,
    end_s: f64,
) -> Parking {
    let mut drive = Drive::<T, M, U>::start(motion, plant, body, &home()(0.0), dt);
    let mut observer = ParkingObserver::start(&drive.applied());
    observer.tick(0.0, dt, &drive.error(&home()(0.0)), &drive.applied());
    observer.ticks = 0;
    while drive.t < end_s {
        drive.advance(home());
        observer.tick(drive.t, dt, &drive.error(&home()(0.0)), &drive.applied());
    }
    observer.end(drive.report().outcome == Outcome::Parked)
}

/// The largest of every figure, and the mean of `near_s` and `arrived_s`.
pub fn worst(runs: &[Parking]) -> (Parking, f64, f64) {
    let mut all = Parking {
        late_s: f64::NEG_INFINITY,
        ..Parking::default()
    };
    let (mut near, mut arrived) = (0.0, 0.0);
    for run in runs {
        near += run.near_s / runs.len() as f64;
        arrived += run.arrived_s / runs.len() as f64;
        all = Parking {
            near_s: all.near_s.max(run.near_s),
            arrived_s: all.arrived_s.max(run.arrived_s),
            changes: all.changes.max(run.changes),
            late_s: all.late_s.max(run.late_s),
            left: PoseError {
                x: all.left.x.max(run.left.x),
                y: all.left.y.max(run.left.y),
                theta: all.left.theta.max(run.left.theta),
            },
            force: all.force.max(run.force),
            moment: all.moment.max(run.moment),
            torque_rate: all.torque_rate.max(run.torque_rate),
            first: (all.first.0.max(run.first.0), all.first.1.max(run.first.1)),
            start: (all.start.0.max(run.start.0), all.start.1.max(run.start.1)),
            lost: all.lost + run.lost,
        };
    }
    (all, near, arrived)
}

/// One line of a table, printed.
pub fn print(name: &str, runs: &[Parking]) -> Parking {
    let (all, near, arrived) = worst(runs);
    println!(
        "{name:44} near {:5.2}/{near:4.2} s  arrived {:5.2}/{arrived:4.2} s  changes {:2}  late {:5.2} s  \
         left {:.4} {:.4} mm {:.3} mrad  F {:3.0} N {:3.0}  rate {:5.1} N m/s  first {:.1e} {:.1e}  lost {}",
        all.near_s,
        all.arrived_s,
        all.changes,
        all.late_s,
        1e3 * all.left.x,
        1e3 * all.left.y,
        1e3 * all.left.theta,
        all.force,
        all.moment,
        all.torque_rate,
        all.first.0,
        all.first.1,
        all.lost
    );
    all
}

/// All starts, on all cores.
pub fn park_all<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    motion: &ValidMotionParams<T>,
    plant: Base,
    starts: &[Body],
    dt: f64,
    end_s: f64,
) -> Vec<Parking> {
    on_all_cores(starts, |body| {
        park::<T, M, U>(motion, plant, *body, dt, end_s)
    })
}
