//! From orders of the host to the task of the motion law.

use super::io::Order;
use super::locate::coast;
use crate::maths::Maths;
use crate::motion::{PathEnd, Task, ValidMotionParams};
use crate::reference::Reference;
use crate::safety::supervisor::{Action, Event, State, Supervisor};
use crate::scalar::Scalar;
use crate::types::{Accel, Measured, Pose};

/// What came of an order.
pub(super) struct Taken {
    pub(super) refused: bool,
    /// The task parks, and at another goal than the one before, if that parked as well.
    pub(super) other_goal: bool,
}

impl Taken {
    /// The task goes on.
    const GOES_ON: Self = Self {
        refused: false,
        other_goal: false,
    };
}

/// What a reference is led to its path's end by.
pub(super) struct Leading<'a, T> {
    pub(super) end: &'a mut PathEnd<T>,
    pub(super) motion: &'a ValidMotionParams<T>,
    /// `None` before the first reading.
    pub(super) measured: Option<&'a Measured<T>>,
}

/// Takes an order into the task, as far as the supervisor's state allows. Without
/// an order a reference moves on by `dt`, at its twist, and a velocity order stays.
pub(super) fn take<T: Scalar, M: Maths<T>>(
    order: &Order<T>,
    task: &mut Option<Task<T>>,
    supervisor: &mut Supervisor,
    leading: Leading<'_, T>,
    dt: T,
) -> Taken {
    let (new, event) = match order {
        Order::None => {
            if let Some(Task::Follow(reference)) = task {
                *reference = onward::<T, M>(reference, dt);
            }
            return Taken::GOES_ON;
        }
        Order::Follow(reference) => (Task::Follow(*reference), Event::Track),
        Order::Park(goal) => (Task::Park(*goal), Event::Park),
        &Order::Drive {
            twist,
            hold_heading,
        } => (
            Task::Drive {
                twist,
                hold_heading,
            },
            Event::Drive,
        ),
    };
    let other_goal = match (&*task, &new) {
        (Some(Task::Park(old)), Task::Park(new)) => {
            let state = supervisor.state();
            if old == new && (state.drives() || state == State::Parked) {
                return Taken::GOES_ON;
            }
            old != new
        }
        _ => false,
    };
    let refused = supervisor.on(event) == Action::Refuse;
    if !refused {
        // Of one path what is left becomes less from tick to tick.
        let before = match task {
            Some(Task::Follow(last)) => last.left_m(),
            _ => T::ZERO,
        };
        *task = Some(new);
        if let (Some(Task::Follow(reference)), Some(measured)) = (task, leading.measured)
            && reference.left_m() > T::ZERO
        {
            let goes_on = before >= reference.left_m();
            leading.lead::<M>(reference, &measured.pose, goes_on, dt);
        }
    }
    Taken {
        refused,
        other_goal: other_goal && !refused,
    }
}

impl<T: Scalar> Leading<'_, T> {
    /// Only in a path's last drive, so apart from other ticks.
    #[inline(never)]
    fn lead<M: Maths<T>>(self, reference: &mut Reference<T>, at: &Pose<T>, goes_on: bool, dt: T) {
        if !goes_on {
            *self.end = PathEnd::NEW;
        }
        self.end.lead::<M>(self.motion, reference, at, dt);
    }
}

/// A reference a tick on, by its twist.
fn onward<T: Scalar, M: Maths<T>>(reference: &Reference<T>, dt: T) -> Reference<T> {
    let from = Measured {
        pose: *reference.pose(),
        twist: *reference.twist(),
    };
    let Measured { pose, twist } = coast::<T, M>(&from, dt);
    let left = reference.left_m() - dt * twist.linear.abs();
    Reference::new_with::<M>(pose, twist, Accel::default()).with_left(left)
}
