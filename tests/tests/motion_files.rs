//! Trajectory files to their planned end, and parked there, with the tolerance of most users.

use controller_core::maths::Single;
use controller_core::motion::{MotionParams, Outcome, Task};
use controller_core::reference::Reference;
use controller_core::shunting::RationalMean;
use controller_core::types::{Accel, Pose, Twist, Wrench};
use sim_host::drive::{FileRun, Retiming, trajectory};
use sim_host::import::Trajectory;
use sim_host::mission::BaseSpec;
use tests::fixtures::{self, DRIVABLE};
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Drive, Order};
use tests::stated::{At, Stated};
use tests::tuning_loop::{BASES, file};

/// The run until its end, then its last pose.
fn order(run: &Trajectory, t: f64) -> Order {
    let s = run.at(t.min(run.duration()));
    let pose = Pose::new(s.x, s.y, s.theta);
    if t < run.duration() {
        let (twist, accel) = (Twist::new(s.v, s.w), Accel::new(s.a, s.alpha));
        Task::Follow(Reference::new(pose, twist, accel))
    } else {
        Task::Park(pose)
    }
}

/// Ends at rest.
fn stops(path: &Trajectory) -> bool {
    let end = path.at(path.duration());
    end.v.abs() < 1e-6 && end.w.abs() < 1e-6
}

/// Drives a run from rest, beside its start where it is long enough; how long after its end the robot
/// says for good that it is parked \[s\].
fn parks_after(run: &Trajectory, spec: &BaseSpec, heavier: f64, nimbler: f64) -> f64 {
    let params = spec.motion();
    let mut single = MotionParams::<f32>::new(params.robot.cast(), params.limits.cast());
    single.gains = params.gains.cast();
    single.arrival.distance_m = 5e-3;
    single.arrival.heading_rad = 10e-3;
    let motion = single.validate().expect("valid");
    let believed = Base::of(&params);
    let base = Base {
        mass: heavier * believed.mass,
        inertia: nimbler * believed.inertia,
        ..believed
    };
    let first = run.at(0.0);
    let aside = FileRun::default().offset_on(run.figures().length_m, run.duration());
    let (sin, cos) = first.theta.sin_cos();
    let start = Body::at(first.x - aside * sin, first.y + aside * cos, first.theta);
    let mut drive = Drive::<f32, Single, RationalMean>::start(
        &motion,
        base,
        start,
        &order(run, 0.0),
        spec.period_s(),
    );
    let mut parked_s = 0.0;
    while drive.t < run.duration() + 10.0 {
        drive.coast(&Wrench::default());
        let measured = drive.body.measured();
        drive.take(&order(run, drive.t), &measured);
        if drive.report().outcome != Outcome::Parked {
            parked_s = drive.t;
        }
    }
    assert_eq!(drive.report().outcome, Outcome::Parked);
    parked_s - run.duration()
}

/// Every file on every base, with the mass and the inertia that the controller believes, and with others. All end at rest: three state no
/// speeds.
#[test]
fn files_are_parked_soon_after_their_planned_end() {
    let cases: Vec<_> = DRIVABLE
        .into_iter()
        .map(|name| fixtures::read(name).expect("a fixture"))
        .map(|bytes| trajectory(&bytes, &Retiming::default()).expect("drivable"))
        .flat_map(|path| BASES.map(|base| (path.clone(), base)))
        .collect();
    assert_eq!(cases.len(), 14 * BASES.len());
    assert!(cases.iter().all(|(path, _)| stops(path)));
    let late = on_all_cores(&cases, |(path, base)| {
        let spec = file(base);
        let (run, _) = Retiming::default()
            .of(path, &spec)
            .expect("a base's limits");
        assert!(stops(&run), "{base}: {:?}", run.at(run.duration()));
        [(1.0, 1.0), (1.3, 0.7)].map(|(mass, inertia)| parks_after(&run, &spec, mass, inertia))
    });
    let mut figures = [[0.0; 2]; 2];
    for (i, most) in [0.3, 0.5].into_iter().enumerate() {
        let mut late: Vec<f64> = late.iter().map(|late| late[i]).collect();
        late.sort_by(f64::total_cmp);
        let nearly_all = late[(0.95 * late.len() as f64).ceil() as usize - 1];
        assert!(nearly_all <= most, "{late:?}");
        figures[i] = [nearly_all, late[late.len() - 1]];
    }
    let [[usual, worst], [other, worst_other]] = figures;
    let mut page = Stated::of("docs/trajectories.md");
    page.at_most(
        At::Phrase("say that they are parked # s after the planned end on"),
        &[usual],
    );
    page.at_most(At::Phrase("(# s with 1.3 of the mass"), &[other]);
    page.at_most(
        At::Phrase("from 0.15 m beside its start, # and # s"),
        &[worst, worst_other],
    );
}
