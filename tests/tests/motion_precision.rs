//! Single against double precision over whole runs.

use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::Task;
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use controller_core::types::{Pose, Wrench};
use tests::ideal::Robot;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Drive, Order, goal, hand_over_states, steady};
use tests::motion_tracking::Exact;
use tests::stated::{At, Stated};
use tests::tolerance::{MOTION_PLANT, MOTION_SINGLE_POSE};

/// Robot poses every tick.
fn poses<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    body: Body,
    orders: impl Fn(f64) -> Order,
    end_s: f64,
) -> Vec<Pose<f64>> {
    let motion = Base::STANDARD.params::<T, M>().validate().expect("valid");
    let mut drive = Drive::<T, M, U>::start(&motion, Base::STANDARD, body, &orders(0.0), 0.01);
    let mut poses = Vec::new();
    while drive.t < end_s {
        drive.advance(&orders);
        poses.push(drive.body.pose);
    }
    poses
}

/// Largest difference of a coordinate.
fn largest(a: &[Pose<f64>], b: &[Pose<f64>]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| {
        let turned = controller_core::angle::wrap(a.theta - b.theta);
        (a.x - b.x).abs().max((a.y - b.y).abs()).max(turned.abs())
    });
    differences.fold(0.0, f64::max)
}

/// Case 2 with parking at its end, until the latch, whose tick may differ by one.
#[test]
fn single_precision_follows_double_precision() {
    let path = steady(0.4, 0.15);
    let target = goal(&path(10.0));
    let orders = |t: f64| if t < 9.4 { path(t) } else { Task::Park(target) };
    let body = Body::at(0.0, 1.0, 0.0);
    let double = poses::<f64, Libm, ExactMean>(body, orders, 11.0);
    let single = poses::<f32, Single, ExactMean>(body, orders, 11.0);
    let rational = poses::<f64, Libm, RationalMean>(body, orders, 11.0);
    let both = poses::<f32, Single, RationalMean>(body, orders, 11.0);
    let exact = largest(&double, &single);
    let mean = largest(&double, &rational);
    println!(
        "f32 {exact:.1e}, rational mean {mean:.1e}, f32 beside it {:.1e}",
        largest(&rational, &both)
    );
    let most = exact.max(largest(&rational, &both));
    assert!(most < MOTION_SINGLE_POSE);
    Stated::of("docs/motion.md").exactly(At::Phrase("along case 2 # m or rad"), &[most]);
}

/// All hand-over states.
#[test]
fn single_precision_parks_like_double_precision() {
    let mut all = 0.0_f64;
    for body in hand_over_states() {
        let orders = |_| Task::Park(Pose::default());
        let double = poses::<f64, Libm, ExactMean>(body, orders, 3.0);
        let single = poses::<f32, Single, ExactMean>(body, orders, 3.0);
        all = all.max(largest(&double, &single));
    }
    println!("parking: f32 differs by {all:.1e}");
    assert!(all < MOTION_SINGLE_POSE);
    Stated::of("docs/motion.md").exactly(At::Phrase("from the hand-over states #."), &[all]);
}

/// The same inputs give the same bits.
#[test]
fn runs_are_reproducible() {
    let body = Body::at(-1.0, 0.7, 2.0);
    let run = || poses::<f32, Single, RationalMean>(body, |_| Task::Park(Pose::default()), 10.0);
    assert_eq!(run(), run());
}

/// The robot of these tests against the oracle's, whose quadrature is ten times finer.
#[test]
fn plant_agrees_with_the_oracle() {
    use nalgebra::{Vector2, Vector3};
    let p = tests::oracle::Params::recommended();
    let mut exact = tests::plant::Body {
        q: Vector3::zeros(),
        twist: Vector2::new(0.5, 1.0),
    };
    let mut body = Body::default();
    body.twist.linear = 0.5;
    body.twist.angular = 1.0;
    for k in 0..1000 {
        let (force, moment) = (20.0 * f64::from(k).sin(), 30.0 * f64::from(k).cos());
        exact = exact.after(&p, &Vector2::new(force, moment), 0.01);
        body = body.after(&Base::STANDARD, &Wrench { force, moment }, 0.01);
    }
    assert!((exact.q.x - body.pose.x).abs() < MOTION_PLANT);
    assert!((exact.q.y - body.pose.y).abs() < MOTION_PLANT);
    assert!((exact.q.z - body.pose.theta).abs() < MOTION_PLANT);
}

/// 10 ms and 1 ms agree to what holding a torque costs.
#[test]
fn tick_hardly_matters() {
    let run = |dt: f64| {
        let motion = Base::STANDARD.exact().validate().expect("valid");
        let path = steady(0.4, 0.15);
        let body = Body::at(0.0, 1.0, 0.0);
        let mut drive = Exact::start(&motion, Base::STANDARD, body, &path(0.0), dt);
        while drive.t < 5.0 - dt / 2.0 {
            drive.advance(path);
        }
        drive.body.pose
    };
    let difference = largest(&[run(0.01)], &[run(0.001)]);
    println!("10 ms and 1 ms differ by {difference:.1e}");
    assert!(difference < 1e-3);
}
