//! Reference accelerations are fed forward exactly; through acceleration neurons they lag.

use controller_core::maths::Libm;
use controller_core::motion::Task;
use controller_core::paper::demand::Demand;
use controller_core::paper::params::Params;
use controller_core::pose_error::pose_error;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};
use tests::core_loop::Exact as Paper;
use tests::ideal::Loop;
use tests::motion_base::{Base, Body};
use tests::motion_loop::Order;
use tests::motion_tracking::follow;
use tests::stated::{At, Stated};
use tests::tolerance::{FED_FORWARD_RMS, MEAN_ORDER};

/// Speed 0.6 + 0.3 sin 1.3 t, heading 0.8 sin t: up to 0.39 m/s² and 0.8 rad/s².
fn snake(t: f64) -> (Twist<f64>, Accel<f64>, f64) {
    let twist = Twist::new(0.6 + 0.3 * (1.3 * t).sin(), 0.8 * t.cos());
    let accel = Accel::new(0.39 * (1.3 * t).cos(), -0.8 * t.sin());
    (twist, accel, 0.8 * t.sin())
}

/// Poses of [`snake`] every 1 ms, by Simpson's rule.
struct Path(Vec<Pose<f64>>);

/// Spacing of [`Path`] \[s\].
const STEP: f64 = 1e-3;

impl Path {
    fn new(end_s: f64) -> Self {
        let velocity = |t: f64| {
            let (twist, _, theta) = snake(t);
            (twist.linear * theta.cos(), twist.linear * theta.sin())
        };
        let mut poses = vec![Pose::default()];
        for k in 0..(end_s / STEP) as u32 + 2 {
            let t = f64::from(k) * STEP;
            let (a, b, c) = (velocity(t), velocity(t + STEP / 2.0), velocity(t + STEP));
            let last: &Pose<f64> = &poses[poses.len() - 1];
            poses.push(Pose::new(
                last.x + STEP / 6.0 * (a.0 + 4.0 * b.0 + c.0),
                last.y + STEP / 6.0 * (a.1 + 4.0 * b.1 + c.1),
                snake(t + STEP).2,
            ));
        }
        Self(poses)
    }

    /// The sample of a tick of `dt`, its acceleration taken `ahead` of it.
    fn at(&self, t: f64, ahead: f64) -> Reference<f64> {
        let pose = self.0[(t / STEP).round() as usize];
        Reference::new_with::<Libm>(pose, snake(t).0, snake(t + ahead).1)
    }

    fn order(&self, ahead: f64) -> impl Fn(f64) -> Order + '_ {
        move |t| Task::Follow(self.at(t, ahead))
    }
}

/// The start of a run: 5 cm beside the path, moving with it.
fn beside() -> Body {
    let mut body = Body::at(0.0, -0.05, 0.0);
    body.twist = snake(0.0).0;
    body
}

const END_S: f64 = 30.0;

/// Root mean square of the distance in the second half, with the paper's law.
fn paper_rms(path: &Path, dt: f64) -> f64 {
    let params = Params::paper().validate().expect("valid");
    let body = beside();
    let law = Paper::start(&params, &path.at(0.0, 0.0), &body.measured()).expect("a finite start");
    let mut drive = Loop::new(law, body, Base::STANDARD, dt);
    let (mut squares, mut count) = (0.0, 0.0);
    for _ in 1..=(END_S / dt) as u32 {
        let wrench = drive.controller.report().wrench;
        drive.hold(&wrench);
        let Loop { body, t, .. } = drive;
        let sample = path.at(t, 0.0);
        drive
            .controller
            .step(dt, &Demand::Track(sample), &body.measured())
            .expect("a finite tick");
        let error = pose_error::<f64, Libm>(sample.pose(), &body.pose);
        if t > END_S / 2.0 {
            squares += error.x * error.x + error.y * error.y;
            count += 1.0;
        }
    }
    f64::sqrt(squares / count)
}

/// Below 3 mm at 10 ms, where the paper's law has tens of millimetres.
#[test]
fn accelerating_reference_is_followed_to_millimetres() {
    let base = Base::STANDARD;
    let motion = base.exact().validate().expect("valid");
    let path = Path::new(END_S + 1.0);
    let dt = 0.01;
    let mid = follow(&motion, base, beside(), dt, END_S, path.order(dt / 2.0));
    let now = follow(&motion, base, beside(), dt, END_S, path.order(0.0));
    let paper = paper_rms(&path, dt);
    println!(
        "rms {:.2} mm (acceleration half a tick ahead), {:.2} mm (of now), paper's law {:.1} mm",
        1e3 * mid.rms,
        1e3 * now.rms,
        1e3 * paper
    );
    assert!(mid.rms < FED_FORWARD_RMS && mid.peak < 2.0 * FED_FORWARD_RMS);
    assert!(now.rms < FED_FORWARD_RMS && mid.rms < now.rms);
    assert!(paper > 10.0 * mid.rms);
    let mut page = Stated::of("docs/motion.md");
    page.exactly(At::Phrase("rad/s²): # mm RMS, below"), &[1e3 * now.rms]);
    page.at_most(
        At::Phrase(", below # mm with accelerations sampled half"),
        &[1e3 * mid.rms],
    );
    page.exactly(At::Phrase("The paper's law: # mm."), &[1e3 * paper]);
    Stated::of("docs/derivation.md").exactly(
        At::Phrase("which lag: # mm RMS on a weaving one, where exact feed-forward leaves # mm"),
        &[1e3 * paper, 1e3 * now.rms],
    );
    let mut readme = Stated::of("README.md");
    readme.exactly(
        At::Phrase("through neurons: # mm RMS on a weaving reference | fed forward: # mm RMS"),
        &[1e3 * paper, 1e3 * now.rms],
    );
}

/// What is left comes from holding torques: it falls with the tick.
#[test]
fn error_left_is_that_of_held_torques() {
    let base = Base::STANDARD;
    let motion = base.exact().validate().expect("valid");
    let path = Path::new(END_S + 1.0);
    let rms = |dt: f64| follow(&motion, base, beside(), dt, END_S, path.order(0.0)).rms;
    let (coarse, fine) = (rms(0.01), rms(0.001));
    println!(
        "rms {:.3} mm at 10 ms, {:.4} mm at 1 ms",
        1e3 * coarse,
        1e3 * fine
    );
    Stated::of("docs/motion.md")
        .exactly(At::Phrase("half a tick ahead, # mm at 1 ms"), &[1e3 * fine]);
    let order = (coarse / fine).log10();
    assert!((order - 1.0).abs() < 4.0 * MEAN_ORDER, "order {order}");
}
