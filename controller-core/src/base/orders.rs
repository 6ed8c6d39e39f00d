//! From orders of the host to the task of the motion law.

use super::io::Order;
use super::locate::coast;
use crate::maths::Maths;
use crate::motion::Task;
use crate::reference::Reference;
use crate::safety::supervisor::{Action, Event, State, Supervisor};
use crate::scalar::Scalar;
use crate::types::{Accel, Measured};

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

/// Takes an order into the task, as far as the supervisor's state allows. Without
/// an order a reference moves on by `dt`, at its twist, and a velocity order stays.
pub(super) fn take<T: Scalar, M: Maths<T>>(
    order: &Order<T>,
    task: &mut Option<Task<T>>,
    supervisor: &mut Supervisor,
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
        *task = Some(new);
    }
    Taken {
        refused,
        other_goal: other_goal && !refused,
    }
}

/// A reference a tick on, by its twist.
fn onward<T: Scalar, M: Maths<T>>(reference: &Reference<T>, dt: T) -> Reference<T> {
    let from = Measured {
        pose: *reference.pose(),
        twist: *reference.twist(),
    };
    let Measured { pose, twist } = coast::<T, M>(&from, dt);
    Reference::new_with::<M>(pose, twist, Accel::default())
}
