//! From references and goals to the order of a tick.

use controller_core::base::Order;
use controller_core::hal::WheelDrive;
use controller_core::maths::Single;
use controller_core::queue::Gap;
use controller_core::reference::Reference;
use controller_core::safety::supervisor::{Event, State};
use controller_core::safety::{Timeout, controlled_stop};
use controller_core::types::{Accel, Pose, Twist};

use super::ControlTask;
use crate::excitation::{Excitation, Motion, Step};
use protocol::RecordingEnd;

/// Where the base is commanded to go.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Course {
    /// Nowhere.
    #[default]
    None,
    /// Along the references.
    Follow {
        /// Time of the first reference \[s\], and since then \[us\].
        first_s: f32,
        run_us: u64,
    },
    /// To a goal that the next tick takes up.
    Depart(Pose<f32>),
    /// To a goal.
    Park(Pose<f32>),
    /// With a speed and a turn rate.
    Drive {
        twist: Twist<f32>,
        hold_heading: bool,
        /// Not ordered yet. Each order is given once: the base counts how old it is.
        new: bool,
    },
    /// By itself, for a recording.
    Excite(Excitation),
}

impl<D: WheelDrive> ControlTask<'_, D> {
    /// What this tick is to do. The base looks whether it fits its state.
    pub(super) fn order(&mut self, elapsed_us: u32) -> Order<f32> {
        let state = self.state();
        match self.course {
            Course::Depart(goal) => self.park(goal),
            Course::Drive {
                twist,
                hold_heading,
                new,
            } => {
                self.course = Course::Drive {
                    twist,
                    hold_heading,
                    new: false,
                };
                if new {
                    Order::Drive {
                        twist,
                        hold_heading,
                    }
                } else {
                    Order::None
                }
            }
            Course::Excite(excitation) => self.excite(excitation, elapsed_us),
            Course::Follow { first_s, run_us } if state == State::Tracking => {
                let run_us = run_us.saturating_add(elapsed_us.into());
                self.course = Course::Follow { first_s, run_us };
                self.follow(first_s + run_us as f32 * 1.0e-6)
            }
            course => {
                let waits = matches!(state, State::Armed | State::Parked);
                match (self.first().filter(|_| waits), course) {
                    (Some((first_s, reference)), _) => {
                        self.course = Course::Follow { first_s, run_us: 0 };
                        Order::Follow(reference)
                    }
                    // The same goal again and again: the base stays there.
                    (None, Course::Park(goal)) => Order::Park(goal),
                    _ => Order::None,
                }
            }
        }
    }

    /// An order in every tick. Of the host a heartbeat is due instead.
    fn excite(&mut self, mut excitation: Excitation, elapsed_us: u32) -> Order<f32> {
        let step = excitation.advance(elapsed_us, self.motion().as_ref());
        self.heartbeat = self.heartbeat.after(elapsed_us, false);
        if self.heartbeat.us() > self.patience_us() {
            self.excitation_end = RecordingEnd::HostSilent;
            self.course = Course::None;
            self.controller.on(Event::LinkLost);
            return Order::None;
        }
        match step {
            Step::Drive(twist) => {
                self.course = Course::Excite(excitation);
                Order::Drive {
                    twist,
                    hold_heading: false,
                }
            }
            Step::End(end) => {
                self.excitation_end = end;
                self.course = Course::None;
                self.controller.on(Event::Stop);
                Order::None
            }
        }
    }

    /// How long a host may be silent that has the base drive by itself. Where a link is not watched this still is.
    fn patience_us(&self) -> u32 {
        match self.params.detectors.command {
            Timeout::AfterUs(limit) => limit,
            Timeout::Off => 100_000,
        }
    }

    /// Where the base is and how a controlled stop would end, as of the last tick.
    fn motion(&self) -> Option<Motion> {
        let report = self.report();
        let measured = report.measured?;
        let (command, rate, error) = match &report.motion {
            Some(motion) => (motion.command, motion.command_rate, motion.velocity_error),
            None => (measured.twist, Accel::default(), Twist::default()),
        };
        let motion = self.controller.base().motion();
        Some(Motion {
            pose: measured.pose,
            twist: measured.twist,
            stopping: controlled_stop::<_, Single>(motion, &command, &rate, &error),
        })
    }

    fn park(&mut self, goal: Pose<f32>) -> Order<f32> {
        self.course = Course::Park(goal);
        Order::Park(goal)
    }

    /// The trajectory is complete.
    fn end(&mut self, goal: Pose<f32>) -> Order<f32> {
        self.controller.on(Event::TrajectoryEnded);
        self.park(goal)
    }

    /// The first of the references that wait, as soon as two of them make a trajectory.
    fn first(&mut self) -> Option<(f32, Reference<f32>)> {
        // Before all times, so what is waiting comes later, and says when.
        let Err(Gap::TooEarly { first_s }) = self.references.at::<Single>(f32::MIN) else {
            return None;
        };
        let reference = self.references.at::<Single>(first_s).ok()?;
        Some((first_s, reference))
    }

    fn follow(&mut self, now_s: f32) -> Order<f32> {
        match self.references.at::<Single>(now_s) {
            Ok(reference) => Order::Follow(reference),
            // A trajectory that ends at rest is complete.
            Err(Gap::Underrun { last }) if last.reference.stands() => {
                self.end(*last.reference.pose())
            }
            // One that ends in motion was cut off: the base goes on as it went until that is too old, then stops.
            Err(_) => Order::None,
        }
    }
}
