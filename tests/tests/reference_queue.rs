//! The queue of timed reference samples: what it interpolates, what it refuses, and that the controller runs from it.

use controller_core::maths::Libm;
use controller_core::paper::demand::Demand;
use controller_core::queue::{Gap, PushError, ReferenceQueue, TimedReference, interpolate};
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::types::{Accel, Pose, Twist};
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::TAU;
use tests::core_draw::cases;
use tests::core_loop::Exact;
use tests::core_params::{measured, sample, spoiled, validated};
use tests::ideal::Loop;
use tests::oracle::laws::Target;
use tests::oracle::{self, Params, Reset, posture};
use tests::plant::Body;
use tests::tolerance::{
    FOLLOWED, INTERPOLATED, INTERPOLATED_ERROR, INTERPOLATED_TWIST, ROUNDED_END,
};

/// The sample of the oracle's reference at `t`.
fn at(reference: &oracle::Reference, t: f64) -> TimedReference<f64> {
    let target = Target {
        twist: reference.twist(t),
        accel: reference.accel(t),
    };
    TimedReference {
        t,
        reference: sample(&reference.posture(t), &target),
    }
}

/// A slalom: v_r = 0.8 + 0.2 sin 2t, w_r = sin 1.5t.
fn slalom() -> oracle::Reference {
    oracle::Reference {
        v1: 0.2,
        omega_v: 2.0,
        w1: 1.0,
        omega_w: 1.5,
        ..oracle::Reference::steady([1.0, -2.0, 3.0], 0.8, 0.0)
    }
}

/// Eq. (6) between samples of an arc: h⁴ v w³/384, and nothing at the samples.
#[test]
fn arc_is_interpolated_within_its_bound() {
    let path = ConstantTwist {
        start: Pose::new(0.3, 0.2, 0.1),
        twist: Twist::new(1.0, 2.0),
    };
    let timed = |t: f64| TimedReference {
        t,
        reference: path.at::<Libm>(t),
    };
    for (h, bound) in [(0.1, INTERPOLATED), (0.05, INTERPOLATED / 16.0)] {
        let (from, to) = (timed(1.0), timed(1.0 + h));
        let mut worst = 0.0;
        for k in 0..=100 {
            let t = 1.0 + h * f64::from(k) / 100.0;
            let found = *interpolate::<f64, Libm>(&from, &to, t).pose();
            let expected = *path.at::<Libm>(t).pose();
            worst = f64::max(worst, (found.x - expected.x).hypot(found.y - expected.y));
            assert!((found.theta - expected.theta).abs() < ROUNDED_END);
        }
        println!("{h} s: {worst:.2e} m");
        assert!(worst <= bound, "{h} s: {worst:e}");
        for end in [from, to] {
            let found = interpolate::<f64, Libm>(&from, &to, end.t);
            let (p, q) = (found.pose(), end.reference.pose());
            assert!((p.x - q.x).hypot(p.y - q.y) <= ROUNDED_END, "ends come out");
            assert_eq!(*found.twist(), path.twist);
            assert_eq!(*found.accel(), Accel::default());
        }
        assert_eq!(
            interpolate::<f64, Libm>(&from, &to, 1.0),
            from.reference,
            "bit for bit"
        );
    }
}

/// The sample with its heading wrapped, and then some whole turns away.
fn turned(mut sample: TimedReference<f64>, turns: i32) -> TimedReference<f64> {
    let mut pose = *sample.reference.pose();
    pose.theta = posture::wrap(pose.theta) + f64::from(turns) * TAU;
    let (twist, accel) = (*sample.reference.twist(), *sample.reference.accel());
    sample.reference = Reference::new_with::<Libm>(pose, twist, accel);
    sample
}

proptest! {
    #![proptest_config(cases(200))]

    /// A slalom with changing speed, its headings given wrapped or with any number of turns, at any instant.
    #[test]
    fn slalom_is_interpolated_whatever_its_turns(
        start in 0.0..8.0_f64, share in 0.0..1.0_f64, turns in (-3..4_i32, -3..4_i32),
    ) {
        let reference = slalom();
        let from = turned(at(&reference, start), turns.0);
        let to = turned(at(&reference, start + 0.1), turns.1);
        let t = start + share * 0.1;
        let found = interpolate::<f64, Libm>(&from, &to, t);
        let expected = at(&reference, t).reference;
        let place = (found.pose().x - expected.pose().x).hypot(found.pose().y - expected.pose().y);
        let heading = posture::wrap(found.pose().theta - expected.pose().theta).abs();
        prop_assert!(place <= INTERPOLATED && heading <= INTERPOLATED, "{place:e} {heading:e}");
        prop_assert!((found.twist().linear - expected.twist().linear).abs() <= INTERPOLATED);
        prop_assert!((found.twist().angular - expected.twist().angular).abs() <= INTERPOLATED);
        prop_assert!((found.accel().linear - expected.accel().linear).abs() <= INTERPOLATED_TWIST);
        prop_assert!((found.accel().angular - expected.accel().angular).abs() <= INTERPOLATED_TWIST);
    }
}

/// What is left of a path is that of an even braking, exactly; before it is known, or where a sample of another path follows, it is 0.
#[test]
fn what_is_left_is_interpolated_in_the_last_drive_only() {
    let braking = |t: f64| {
        let rest = 1.0 - t;
        let twist = Twist::new(-0.5 * rest, 0.0);
        let reference = Reference::new_with::<Libm>(Pose::default(), twist, Accel::new(0.5, 0.0));
        (t, reference.with_left(0.25 * rest * rest))
    };
    let between = |(t, from): (f64, Reference<f64>), (u, to): (f64, Reference<f64>)| {
        let [from, to] = [(t, from), (u, to)].map(|(t, reference)| TimedReference { t, reference });
        let middle = 0.5 * (t + u);
        (
            middle,
            interpolate::<f64, Libm>(&from, &to, middle).left_m(),
        )
    };
    for t in [0.0, 0.3, 0.6, 0.9] {
        let (middle, left) = between(braking(t), braking(t + 0.1));
        let expected = braking(middle).1.left_m();
        assert!((left - expected).abs() < 1e-15, "{t}: {left} {expected}");
    }
    let unknown = |(t, reference): (f64, Reference<f64>)| (t, reference.with_left(0.0));
    assert_eq!(between(unknown(braking(0.2)), braking(0.3)).1, 0.0);
    let other = (0.3, braking(0.0).1);
    assert_eq!(between(braking(0.2), other).1, 0.0);
    assert!(between(braking(0.8), unknown(braking(1.0))).1 > 0.0);
}

/// What does not fit, is no number or runs back is refused, and what was queued stays.
#[test]
fn producer_refuses_overflow_disorder_and_numbers_that_are_none() {
    let mut queue = ReferenceQueue::<f64, 4>::new();
    let (mut producer, mut consumer) = queue.split();
    let reference = slalom();
    assert_eq!(producer.room(), 3);
    for t in [0.0, 0.1, 0.2] {
        assert_eq!(producer.push(at(&reference, t)), Ok(()));
    }
    assert_eq!(producer.push(at(&reference, 0.3)), Err(PushError::Full));
    assert_eq!((producer.room(), consumer.waiting()), (0, 3));
    assert!(consumer.at::<Libm>(0.05).is_ok());
    assert_eq!(producer.room(), 2, "a span takes two samples out");
    for t in [0.2, 0.1, -1.0] {
        assert_eq!(producer.push(at(&reference, t)), Err(PushError::NotLater));
    }
    let good = at(&reference, 0.3);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut samples = vec![TimedReference { t: bad, ..good }];
        samples.extend(
            spoiled(&good.reference, bad)
                .into_iter()
                .chain([good.reference.with_left(bad)])
                .map(|reference| TimedReference { reference, ..good }),
        );
        assert_eq!(samples.len(), 9);
        for sample in samples {
            assert_eq!(producer.push(sample), Err(PushError::NotFinite));
        }
    }
    assert_eq!(producer.push(good), Ok(()), "a refusal changes nothing");
    assert!(consumer.at::<Libm>(0.25).is_ok());
    for error in [PushError::Full, PushError::NotFinite, PushError::NotLater] {
        assert!(error.to_string().contains("reference"), "{error}");
    }
}

/// Before the first sample, between none, and after the last: reported, and mended by what comes later.
#[test]
fn consumer_tells_gaps() {
    let mut queue = ReferenceQueue::<f64, 8>::new();
    let (mut producer, mut consumer) = queue.split();
    let reference = slalom();
    assert_eq!(consumer.at::<Libm>(1.0), Err(Gap::Empty));
    producer.push(at(&reference, 1.0)).expect("room");
    assert_eq!(
        consumer.at::<Libm>(1.0),
        Err(Gap::Empty),
        "one sample is no span"
    );
    producer.push(at(&reference, 1.1)).expect("room");
    assert_eq!(
        consumer.at::<Libm>(0.9),
        Err(Gap::TooEarly { first_s: 1.0 })
    );
    assert_eq!(consumer.at::<Libm>(1.0), Ok(at(&reference, 1.0).reference));
    assert!(consumer.at::<Libm>(1.1).is_ok());
    let last = at(&reference, 1.1);
    assert_eq!(consumer.at::<Libm>(1.2), Err(Gap::Underrun { last }));
    producer.push(at(&reference, 1.2)).expect("room");
    producer.push(at(&reference, 1.3)).expect("room");
    assert!(consumer.at::<Libm>(1.2).is_ok(), "samples arrived");
    assert!(consumer.at::<Libm>(1.25).is_ok());
    assert_eq!(
        consumer.at::<Libm>(1.15),
        Err(Gap::TooEarly { first_s: 1.2 }),
        "passed"
    );
}

/// An instant that is no number is an error and costs no samples.
#[test]
fn consumer_refuses_an_instant_that_is_no_number() {
    let mut queue = ReferenceQueue::<f64, 8>::new();
    let (mut producer, mut consumer) = queue.split();
    let reference = slalom();
    for t in [0.0, 0.1, 0.2, 0.3] {
        producer.push(at(&reference, t)).expect("room");
    }
    assert!(consumer.at::<Libm>(f64::NAN).is_err());
    assert!(
        consumer.at::<Libm>(0.05).is_ok(),
        "the samples are still there"
    );
}

/// 20 s of slalom from samples every 0.1 s at 10 ms ticks: the controller does as with the true reference.
#[test]
fn controller_runs_from_the_queue() {
    let reference = slalom();
    let p = Params::recommended();
    let params = validated::<f64>(&p, Reset::Corrected);
    let drive = |reference_at: &mut dyn FnMut(f64) -> Reference<f64>| {
        let body = Body {
            q: Vector3::new(0.8, -2.5, 2.5),
            twist: Vector2::zeros(),
        };
        let mut places = Vec::new();
        let first = measured(&body.q, &body.twist);
        let controller = Exact::start(&params, &reference_at(0.0), &first).expect("finite");
        let mut report = *controller.report();
        let mut drive = Loop::new(controller, body, p, 10e-3);
        for _ in 1..=2000 {
            let wrench = report.wrench;
            drive.hold(&Vector2::new(wrench.force, wrench.moment));
            let demand = Demand::Track(reference_at(drive.t));
            let now = measured(&drive.body.q, &drive.body.twist);
            let step = drive.controller.step(10e-3, &demand, &now);
            report = *step.expect("a good tick");
            places.push(drive.body.q);
        }
        let e = report.error;
        assert!(e.x.hypot(e.y) < FOLLOWED, "the robot follows: {e:?}");
        places
    };
    let mut queue = ReferenceQueue::<f64, 8>::new();
    let (mut producer, mut consumer) = queue.split();
    let mut pushed = 0;
    let queued = drive(&mut |t| {
        while producer.room() > 0 {
            producer
                .push(at(&reference, f64::from(pushed) * 0.1))
                .expect("room");
            pushed += 1;
        }
        consumer.at::<Libm>(t).expect("the producer is ahead")
    });
    let exact = drive(&mut |t| at(&reference, t).reference);
    let worst = queued
        .iter()
        .zip(&exact)
        .map(|(a, b)| (a - b).amax())
        .fold(0.0, f64::max);
    println!("queue against true reference: {worst:.2e} m or rad");
    assert!(worst <= INTERPOLATED_ERROR, "{worst:e}");
}

/// A second trajectory with times of its own follows a first one that was not finished, and nothing of it is left.
#[test]
fn cleared_queue_takes_another_trajectory() {
    let mut queue = ReferenceQueue::<f64, 8>::new();
    let (mut producer, mut consumer) = queue.split();
    let reference = slalom();
    for t in [5.0, 5.1, 5.2, 5.3] {
        producer.push(at(&reference, t)).expect("room");
    }
    assert!(consumer.at::<Libm>(5.05).is_ok());
    assert_eq!(producer.push(at(&reference, 0.0)), Err(PushError::NotLater));
    consumer.clear();
    assert_eq!((consumer.waiting(), producer.room()), (0, 7));
    assert_eq!(consumer.at::<Libm>(5.05), Err(Gap::Empty));
    producer.restart();
    for t in [0.0, 0.1] {
        producer
            .push(at(&reference, t))
            .expect("another trajectory");
    }
    assert_eq!(consumer.at::<Libm>(0.0), Ok(at(&reference, 0.0).reference));
}

/// The end of a trajectory is known while it is in the span that is in use, or one sample behind it.
#[test]
fn end_is_seen_one_sample_ahead() {
    let path = ConstantTwist {
        start: Pose::default(),
        twist: Twist::new(1.0, 0.0),
    };
    let mut queue = ReferenceQueue::<f64, 8>::new();
    let (mut producer, mut consumer) = queue.split();
    assert!(consumer.end().is_none(), "nothing was asked for yet");
    for k in 0..5 {
        let t = f64::from(k);
        let reference = path.at::<Libm>(t);
        producer
            .push(TimedReference { t, reference })
            .expect("there is room");
    }
    let mut at = |t: f64| {
        consumer.at::<Libm>(t).expect("within");
        consumer.end().map(|(next, last)| (next.t, last.t))
    };
    assert_eq!(at(0.5), None);
    assert_eq!(at(1.5), None);
    assert_eq!(at(2.5), Some((3.0, 4.0)));
    assert_eq!(at(3.5), Some((4.0, 4.0)));
}
