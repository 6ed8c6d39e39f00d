//! Timed reference samples between a producer (radio, flash, planner) and the control tick.
//!
//! One side pushes, the other asks for the reference at an instant; neither ever waits. Between
//! samples the reference is interpolated; underrun and overrun are reported, not repaired.

use crate::angle::wrap;
use crate::maths::Maths;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::{Accel, Pose, Twist};
use core::fmt;
use heapless::spsc;

/// A reference sample and the instant it belongs to \[s\], on the clock of the control tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedReference<T = f32> {
    /// Seconds.
    pub t: T,
    /// The sample.
    pub reference: Reference<T>,
}

/// A queue for up to N − 1 samples. Place it in a `static` or on the stack, then [`split`] it.
///
/// [`split`]: ReferenceQueue::split
#[derive(Debug, Default)]
pub struct ReferenceQueue<T, const N: usize> {
    queue: spsc::Queue<TimedReference<T>, N>,
}

impl<T: Scalar, const N: usize> ReferenceQueue<T, N> {
    /// An empty queue.
    pub const fn new() -> Self {
        Self {
            queue: spsc::Queue::new(),
        }
    }

    /// The two ends; they may live in different interrupt priorities.
    pub fn split(&mut self) -> (ReferenceProducer<'_, T>, ReferenceConsumer<'_, T>) {
        let (producer, consumer) = self.queue.split();
        let producer = ReferenceProducer {
            queue: producer,
            last: None,
        };
        let consumer = ReferenceConsumer {
            queue: consumer,
            span: None,
        };
        (producer, consumer)
    }
}

/// Why a sample was not taken. The queue is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PushError {
    /// No room: the producer is ahead of the control tick by the whole queue.
    Full,
    /// A value is NaN or infinite.
    NotFinite,
    /// Its time is not later than that of the sample before it.
    NotLater,
}

/// Why there is no reference for an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Gap<T> {
    /// The instant asked for is NaN or infinite.
    NotFinite,
    /// Nothing has arrived yet, or only one sample.
    Empty,
    /// The instant is before the oldest sample left.
    TooEarly {
        /// Time of that sample \[s\].
        first_s: T,
    },
    /// The instant is after the newest sample: underrun.
    Underrun {
        /// The newest sample, for a controlled stop from there.
        last: TimedReference<T>,
    },
}

impl fmt::Display for PushError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Full => "the reference queue is full",
            Self::NotFinite => "the reference sample is not finite",
            Self::NotLater => "the reference sample is not later than the one before",
        })
    }
}

impl core::error::Error for PushError {}

/// The end that is written to.
pub struct ReferenceProducer<'a, T> {
    queue: spsc::Producer<'a, TimedReference<T>>,
    last: Option<T>,
}

/// A queue of heapless has at least one slot; its handles forget how many. Where this is known to
/// hold the compiler sees that their divisions by the number of slots cannot fail, and a firmware
/// image has no panic in them, even with the queue in a `static`.
#[inline(always)]
fn has_slots(capacity: usize) -> bool {
    capacity != usize::MAX
}

impl<T: Scalar> ReferenceProducer<'_, T> {
    /// Appends a sample.
    ///
    /// # Errors
    /// The queue is full, the sample not finite, or not later than its predecessor.
    pub fn push(&mut self, sample: TimedReference<T>) -> Result<(), PushError> {
        if !(sample.t.is_finite() && sample.reference.is_finite()) {
            return Err(PushError::NotFinite);
        }
        if self.last.is_some_and(|last| sample.t <= last) {
            return Err(PushError::NotLater);
        }
        if !has_slots(self.queue.capacity()) {
            return Err(PushError::Full);
        }
        self.queue.enqueue(sample).map_err(|_| PushError::Full)?;
        self.last = Some(sample.t);
        Ok(())
    }

    /// Samples that still fit.
    pub fn room(&self) -> usize {
        let capacity = self.queue.capacity();
        if has_slots(capacity) {
            capacity.saturating_sub(self.queue.len())
        } else {
            0
        }
    }

    /// Forgets the last sample's time: the next one begins another trajectory. The other end has to
    /// be [cleared](ReferenceConsumer::clear) before.
    pub fn restart(&mut self) {
        self.last = None;
    }
}

/// The end that the control tick reads.
pub struct ReferenceConsumer<'a, T> {
    queue: spsc::Consumer<'a, TimedReference<T>>,
    /// The two samples around the last instant asked for.
    span: Option<(TimedReference<T>, TimedReference<T>)>,
}

impl<T: Scalar> ReferenceConsumer<'_, T> {
    /// The reference at `t` \[s\], interpolated by [`interpolate`]. Instants must not go back.
    ///
    /// Drops samples that have passed; the work is bounded by the queue's length.
    ///
    /// # Errors
    /// A [`Gap`]; samples are kept, so a later call can succeed.
    pub fn at<M: Maths<T>>(&mut self, t: T) -> Result<Reference<T>, Gap<T>> {
        if !t.is_finite() {
            return Err(Gap::NotFinite);
        }
        let (mut from, mut to) = match self.span {
            Some(span) => span,
            None => {
                // Two samples make a span; one alone stays where it is.
                if self.waiting() < 2 {
                    return Err(Gap::Empty);
                }
                match (self.take(), self.take()) {
                    (Some(from), Some(to)) => (from, to),
                    _ => return Err(Gap::Empty),
                }
            }
        };
        for _ in 0..self.waiting() {
            if t <= to.t {
                break;
            }
            if let Some(next) = self.take() {
                from = to;
                to = next;
            }
        }
        self.span = Some((from, to));
        if t < from.t {
            Err(Gap::TooEarly { first_s: from.t })
        } else if t > to.t {
            Err(Gap::Underrun { last: to })
        } else {
            Ok(interpolate::<T, M>(&from, &to, t))
        }
    }

    /// The end of the trajectory as far as it is known, once it is near: the sample behind the last instant asked for, and the
    /// last one, which is the same or its successor. `None` while more than one sample waits.
    pub fn end(&self) -> Option<(TimedReference<T>, TimedReference<T>)> {
        let (_, to) = self.span?;
        match self.waiting() {
            0 => Some((to, to)),
            1 if has_slots(self.queue.capacity()) => self.queue.peek().map(|last| (to, *last)),
            _ => None,
        }
    }

    /// Samples waiting, without the two that are in use.
    pub fn waiting(&self) -> usize {
        if has_slots(self.queue.capacity()) {
            self.queue.len()
        } else {
            0
        }
    }

    /// Drops every sample, for a trajectory that will not be finished.
    pub fn clear(&mut self) {
        self.span = None;
        for _ in 0..self.waiting() {
            self.take();
        }
    }

    #[inline(always)]
    fn take(&mut self) -> Option<TimedReference<T>> {
        if has_slots(self.queue.capacity()) {
            self.queue.dequeue()
        } else {
            None
        }
    }
}

/// The reference between two samples: cubic Hermite in x, y, θ, in what is left of the path, and in v, w.
///
/// Slopes of pose and path are those of Eq. (6) at the ends, twist slopes the samples' accelerations, and the
/// acceleration is the derivative of the interpolated twist; all three are continuous across
/// samples if the samples are consistent. The error in pose is h⁴/384 times the fourth derivative:
/// 2 µm for 0.1 s samples of an arc at 1 m/s and 2 rad/s (v w³ = 8 m/s⁴). Headings may be wrapped or
/// not: the turn between samples is the one nearest to what their turn rates say.
pub fn interpolate<T: Scalar, M: Maths<T>>(
    from: &TimedReference<T>,
    to: &TimedReference<T>,
    t: T,
) -> Reference<T> {
    let h = to.t - from.t;
    let s = (t - from.t) / h;
    let (a, b) = (&from.reference, &to.reference);
    let (p, q) = (a.pose(), b.pose());
    let (v, w) = (a.twist(), b.twist());
    // The turn between the samples, of which the sampled rates tell all but the rounding.
    let expected = T::HALF * h * (v.angular + w.angular);
    let turn = expected + wrap(q.theta - p.theta - expected);
    let cubic = |from: (T, T), to: (T, T)| hermite(s, h, from, to);
    let (x, _) = cubic(
        (p.x, v.linear * a.heading().cos),
        (q.x, w.linear * b.heading().cos),
    );
    let (y, _) = cubic(
        (p.y, v.linear * a.heading().sin),
        (q.y, w.linear * b.heading().sin),
    );
    let (theta, _) = cubic((p.theta, v.angular), (p.theta + turn, w.angular));
    let (linear, linear_rate) = cubic((v.linear, a.accel().linear), (w.linear, b.accel().linear));
    let (angular, angular_rate) = cubic(
        (v.angular, a.accel().angular),
        (w.angular, b.accel().angular),
    );
    // Before a path's last drive nothing is said of its end, and what is left of it only falls.
    let left = if a.left_m() > b.left_m() {
        let falls = [v, w].map(|twist| -twist.linear.abs());
        cubic((a.left_m(), falls[0]), (b.left_m(), falls[1])).0
    } else {
        T::ZERO
    };
    Reference::new_with::<M>(
        Pose { x, y, theta },
        Twist::new(linear, angular),
        Accel::new(linear_rate, angular_rate),
    )
    .with_left(left)
}

/// Value and slope at s in [0, 1] of the cubic through two (value, slope) pairs `h` apart.
fn hermite<T: Scalar>(s: T, h: T, (p, dp): (T, T), (q, dq): (T, T)) -> (T, T) {
    let (two, three) = (T::from_f64(2.0), T::from_f64(3.0));
    let rise = q - p;
    // p + s (h dp + s (c2 + s c3)): the ends come out exactly.
    let c2 = three * rise - h * (two * dp + dq);
    let c3 = h * (dp + dq) - two * rise;
    let value = p + s * (h * dp + s * (c2 + s * c3));
    let slope = dp + s * (two * c2 + three * s * c3) / h;
    (value, slope)
}
