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

#[cfg(test)]
mod tests {
    use super::{Leading, Taken, take};
    use crate::base::Order;
    use crate::maths::Libm;
    use crate::motion::{Limits, MotionParams, PathEnd, Task, ValidMotionParams};
    use crate::reference::Reference;
    use crate::robot::Robot;
    use crate::safety::supervisor::{Event, State, Supervisor, SupervisorParams};
    use crate::types::{Accel, Measured, Pose, Twist};

    const DT: f64 = 0.01;

    /// What a base has beside its orders.
    struct Bench {
        motion: ValidMotionParams<f64>,
        supervisor: Supervisor,
        task: Option<Task<f64>>,
        end: PathEnd<f64>,
        measured: Option<Measured<f64>>,
    }

    impl Bench {
        fn after(events: &[Event]) -> Self {
            let motion = MotionParams::new(Robot::paper(), Limits::PAPER).validate();
            let supervisor = SupervisorParams::DEFAULT.validate();
            let mut supervisor = Supervisor::new(&supervisor.expect("valid"));
            for event in events {
                supervisor.on(*event);
            }
            Self {
                motion: motion.expect("valid"),
                supervisor,
                task: None,
                end: PathEnd::NEW,
                measured: None,
            }
        }

        /// What came of an order: refused, another goal.
        fn take(&mut self, order: &Order<f64>) -> (bool, bool) {
            let leading = Leading {
                end: &mut self.end,
                motion: &self.motion,
                measured: self.measured.as_ref(),
            };
            let Taken {
                refused,
                other_goal,
            } = take::<_, Libm>(order, &mut self.task, &mut self.supervisor, leading, DT);
            (refused, other_goal)
        }

        /// The reference that is followed.
        fn reference(&self) -> Reference<f64> {
            match self.task {
                Some(Task::Follow(reference)) => reference,
                other => panic!("{other:?}"),
            }
        }
    }

    fn reference(twist: Twist<f64>, left: f64) -> Reference<f64> {
        let pose = Pose::new(1.0, 2.0, 0.5);
        let accel = Accel::new(-0.1, 0.0);
        Reference::new_with::<Libm>(pose, twist, accel).with_left(left)
    }

    #[test]
    fn what_the_state_does_not_allow_changes_nothing() {
        let mut bench = Bench::after(&[]);
        for order in [
            Order::Follow(reference(Twist::new(0.3, 0.0), 0.0)),
            Order::Park(Pose::default()),
            Order::Drive {
                twist: Twist::default(),
                hold_heading: true,
            },
        ] {
            assert_eq!(bench.take(&order), (true, false));
            assert_eq!((bench.task, bench.supervisor.state()), (None, State::Idle));
        }
        assert_eq!(bench.take(&Order::None), (false, false));
        assert_eq!(bench.task, None);
    }

    /// Without an order a reference goes on along its arc, forward and backward, and so much less of the path is left. A goal and a
    /// velocity stay.
    #[test]
    fn without_an_order_the_task_goes_on() {
        for (v, w) in [(0.4, 0.5), (-0.4, 0.5), (0.0, 1.0)] {
            let mut bench = Bench::after(&[Event::Arm]);
            let from = reference(Twist::new(v, w), 0.3);
            assert_eq!(bench.take(&Order::Follow(from)), (false, false));
            bench.take(&Order::None);
            let on = bench.reference();
            let (radius, turned) = (v / w, w * DT);
            let x = 1.0 + radius * ((0.5 + turned).sin() - 0.5_f64.sin());
            let y = 2.0 - radius * ((0.5 + turned).cos() - 0.5_f64.cos());
            let pose = on.pose();
            assert!((pose.x - x).abs() < 1e-14 && (pose.y - y).abs() < 1e-14);
            assert_eq!(pose.theta, 0.5 + turned);
            assert_eq!(
                (*on.twist(), *on.accel()),
                (*from.twist(), Accel::default())
            );
            assert_eq!(on.left_m(), 0.3 - DT * v.abs());
        }
        for order in [
            Order::Park(Pose::default()),
            Order::Drive {
                twist: Twist::new(0.1, 0.0),
                hold_heading: false,
            },
        ] {
            let mut bench = Bench::after(&[Event::Arm]);
            bench.take(&order);
            let before = bench.task;
            bench.take(&Order::None);
            assert_eq!(bench.task, before);
        }
    }

    /// The goal of a base that parks or is parked, again: nothing happens. Another one is said to be another one; after a stop the same one
    /// is refused, which only an order that reaches the supervisor can be.
    #[test]
    fn a_goal_that_is_ordered_again_is_the_same_one() {
        let (here, there) = (Pose::default(), Pose::new(1.0, 0.0, 0.0));
        let mut bench = Bench::after(&[Event::Arm]);
        assert_eq!(bench.take(&Order::Park(here)), (false, false));
        let parks = bench.supervisor;
        assert_eq!(bench.take(&Order::Park(here)), (false, false));
        assert_eq!(bench.supervisor, parks);
        assert_eq!(bench.take(&Order::Park(there)), (false, true));
        bench.supervisor.on(Event::Reached);
        let parked = bench.supervisor;
        assert_eq!(parked.state(), State::Parked);
        assert_eq!(bench.take(&Order::Park(there)), (false, false));
        assert_eq!(bench.supervisor, parked);
        assert_eq!(bench.take(&Order::Park(here)), (false, true));
        assert_eq!(bench.supervisor.state(), State::Parking);
        bench.supervisor.on(Event::Stop);
        assert_eq!(bench.take(&Order::Park(here)), (true, false));
        assert_eq!(bench.take(&Order::Park(there)), (true, false));
        assert_eq!(bench.task, Some(Task::Park(here)));
    }

    /// Who is beside the end of a path is led there; of a path that does not say what is left nobody is.
    #[test]
    fn a_base_is_led_to_the_end_of_its_path() {
        let ends = |left: f64| Order::Follow(reference(Twist::new(0.3, 0.0), left));
        let beside = |aside: f64| Measured {
            pose: Pose::new(
                1.0 - aside * 0.5_f64.sin(),
                2.0 + aside * 0.5_f64.cos(),
                0.5,
            ),
            twist: Twist::new(0.3, 0.0),
        };
        let off = |bench: &Bench| {
            let pose = bench.reference().pose().y - 2.0;
            pose / 0.5_f64.cos()
        };
        let mut bench = Bench::after(&[Event::Arm]);
        // Nothing is measured yet, and then nothing is left of a path that does not say so.
        bench.take(&ends(0.15));
        assert_eq!(off(&bench), 0.0);
        bench.measured = Some(beside(0.005));
        bench.take(&ends(0.0));
        assert_eq!(off(&bench), 0.0);
        bench.take(&ends(0.15));
        // As much of the 5 mm as the angular acceleration can take back on the way.
        let first = off(&bench);
        assert!(first > 0.001 && first < 0.005, "{first}");
        // On the way what leads it fades, wherever it is measured by now.
        bench.measured = Some(beside(0.0));
        bench.take(&ends(0.147));
        let led = bench.end;
        assert!(
            off(&bench) > 0.8 * first && led != PathEnd::NEW,
            "{}",
            off(&bench)
        );
        // More left than before: another path, on which it is.
        bench.take(&ends(0.15));
        assert_eq!((off(&bench), bench.end), (0.0, PathEnd::NEW));
    }
}
