//! Theorem 5: the queue of references is a list, for every sequence of calls.

use std::collections::VecDeque;

use controller_core::maths::Libm;
use controller_core::queue::{Gap, PushError, ReferenceQueue, TimedReference};
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};

/// Calls in a sequence.
const LENGTH: u32 = 7;
/// Samples that fit.
const ROOM: usize = 3;

/// At 1 m/s along x: where t is.
fn sample(t: f64) -> TimedReference<f64> {
    let (pose, twist) = (Pose::new(t, 0.0, 0.0), Twist::new(1.0, 0.0));
    TimedReference {
        t,
        reference: Reference::new(pose, twist, Accel::default()),
    }
}

/// What the two ends are to be: lists of times.
#[derive(Default)]
struct Model {
    waiting: VecDeque<f64>,
    span: Option<(f64, f64)>,
    pushed: Option<f64>,
    asked: f64,
}

impl Model {
    fn push(&mut self, t: f64) -> Result<(), PushError> {
        if !t.is_finite() {
            Err(PushError::NotFinite)
        } else if self.pushed.is_some_and(|last| t <= last) {
            Err(PushError::NotLater)
        } else if self.waiting.len() == ROOM {
            Err(PushError::Full)
        } else {
            self.waiting.push_back(t);
            self.pushed = Some(t);
            Ok(())
        }
    }

    /// x of the reference at `t`.
    fn at(&mut self, t: f64) -> Result<f64, Gap<f64>> {
        if !t.is_finite() {
            return Err(Gap::NotFinite);
        }
        if self.span.is_none() {
            if self.waiting.len() < 2 {
                return Err(Gap::Empty);
            }
            let mut two = self.waiting.drain(..2);
            self.span = two.next().zip(two.next());
        }
        while let Some((_, to)) = self.span.filter(|(_, to)| t > *to) {
            let Some(next) = self.waiting.pop_front() else {
                return Err(Gap::Underrun { last: sample(to) });
            };
            self.span = Some((to, next));
        }
        match self.span {
            Some((from, _)) if t < from => Err(Gap::TooEarly { first_s: from }),
            _ => Ok(t),
        }
    }
}

/// Pushes of later, equal and impossible times, questions before, in, behind and far behind what is there, all lists cleared.
#[test]
fn the_queue_of_references_is_a_list_for_every_sequence_of_calls() {
    const CALLS: u32 = 9;
    let mut held = 0;
    for number in 0..CALLS.pow(LENGTH) {
        let mut queue = ReferenceQueue::<f64, { ROOM + 1 }>::new();
        let (mut producer, mut consumer) = queue.split();
        let mut model = Model::default();
        for place in 0..LENGTH {
            let last = model.pushed.unwrap_or(0.0);
            let mut push = |t: f64, model: &mut Model| {
                assert_eq!(
                    producer.push(sample(t)),
                    model.push(t),
                    "{number} at {place}"
                );
            };
            let mut ask = |t: f64, model: &mut Model| {
                let found = consumer.at::<Libm>(t).map(|reference| reference.pose().x);
                match (found, model.at(t)) {
                    (Ok(x), Ok(expected)) => {
                        held += 1;
                        assert!((x - expected).abs() < 1e-12, "{number} at {place}: {x}");
                    }
                    (found, expected) => assert_eq!(found, expected, "{number} at {place}"),
                }
                if t.is_finite() {
                    model.asked = model.asked.max(t);
                }
            };
            match number / CALLS.pow(place) % CALLS {
                0 => push(last + 1.0, &mut model),
                1 => push(last + 0.25, &mut model),
                2 => push(last, &mut model),
                3 => push(f64::NAN, &mut model),
                4 => ask(model.asked, &mut model),
                5 => ask(model.asked + 0.5, &mut model),
                6 => ask(model.asked + 2.0, &mut model),
                7 => ask(f64::INFINITY, &mut model),
                _ => {
                    consumer.clear();
                    producer.restart();
                    model = Model {
                        asked: 0.0,
                        ..Model::default()
                    };
                }
            }
            assert_eq!(consumer.waiting(), model.waiting.len());
            assert_eq!(producer.room(), ROOM - model.waiting.len());
            let end = model.span.and_then(|(_, to)| match model.waiting.len() {
                0 => Some((to, to)),
                1 => model.waiting.front().map(|last| (to, *last)),
                _ => None,
            });
            let found = consumer.end().map(|(to, last)| (to.t, last.t));
            assert_eq!(found, end, "{number} at {place}");
        }
    }
    println!("{} sequences, {held} references", CALLS.pow(LENGTH));
    assert!(held > 10_000);
}
