//! Commands of a host.

use controller_core::hal::WheelDrive;
use controller_core::localiser::Fix;
use controller_core::maths::Single;
use controller_core::motion::{check_goal, check_order};
use controller_core::motor::DriverParams;
use controller_core::safety::controlled_stop_distance;
use controller_core::safety::supervisor::{Action, Event, State, next};
use controller_core::types::Pose;

use super::course::Course;
use super::{ControlTask, SetError};
use crate::excitation::Excitation;
use protocol::{Command, RecordingEnd, RejectReason};

impl<D: WheelDrive> ControlTask<'_, D> {
    /// Takes a command; what it asks of the wheels happens in the next tick, an emergency stop in this call.
    ///
    /// References do not come this way but by the queue, and storage is the [`ControlServer`](crate::control_server::ControlServer)'s business.
    ///
    /// # Errors
    ///
    /// Why it is refused; then nothing has changed but the time since the last command of the host.
    pub fn command(&mut self, command: &Command) -> Result<(), RejectReason> {
        self.host_seen();
        match command {
            Command::Heartbeat => {
                self.heartbeat_seen();
                Ok(())
            }
            Command::Arm => self.ask(Event::Arm),
            Command::Stop => self.ask(Event::Stop),
            Command::ResetFault => self.ask(Event::Reset),
            Command::EmergencyStop { brake } => {
                self.emergency_stop(*brake);
                Ok(())
            }
            Command::Park { goal } => {
                let goal = checked(goal.into())?;
                if matches!(next(self.state(), Event::Park).1, Action::Refuse) {
                    return Err(RejectReason::State);
                }
                self.course = Course::Depart(goal);
                Ok(())
            }
            Command::Drive {
                twist,
                hold_heading,
            } => {
                let twist = twist.into();
                check_order(&twist).map_err(|_| RejectReason::Value)?;
                if matches!(next(self.state(), Event::Drive).1, Action::Refuse) {
                    return Err(RejectReason::State);
                }
                // What was sent of a trajectory is not driven any more.
                self.references.clear();
                self.course = Course::Drive {
                    twist,
                    hold_heading: *hold_heading,
                    new: true,
                };
                Ok(())
            }
            Command::Excite(order) => {
                if matches!(self.params.driver, DriverParams::Speeds(_)) {
                    // What such drivers exert nobody here knows, and a row is to have it.
                    return Err(RejectReason::Unsupported);
                }
                if self.state() != State::Armed {
                    return Err(RejectReason::State);
                }
                let motion = self.controller.base().motion();
                let params = motion.params();
                let track_m = params.robot.wheels.track_m;
                let stop_m = |speed| controlled_stop_distance::<_, Single>(motion, speed);
                let excitation = Excitation::new(order, &params.limits, track_m, stop_m)
                    .ok_or(RejectReason::Value)?;
                self.references.clear();
                self.heartbeat_seen();
                self.excitation_end = RecordingEnd::Stopped;
                self.course = Course::Excite(excitation);
                Ok(())
            }
            Command::SetPose { pose } => {
                let pose = checked(pose.into())?;
                self.controller
                    .set_pose(pose)
                    .map_err(|_| RejectReason::Value)
            }
            Command::Fix { pose, age_s } => {
                let pose = checked(pose.into())?;
                if !(age_s.is_finite() && *age_s >= 0.0) {
                    return Err(RejectReason::Value);
                }
                if self.params.localiser.fusion.is_none() {
                    return Err(RejectReason::Unsupported);
                }
                let age_s = *age_s;
                self.fix = Some(Fix { pose, age_s });
                Ok(())
            }
            Command::SetParameters(field) => self.set_field(field).map_err(RejectReason::from),
            Command::LoadDefaults => self.load_defaults().map_err(RejectReason::from),
            Command::SaveParameters
            | Command::Sample(_)
            | Command::GetParameters
            | Command::GetCounters => Err(RejectReason::Unsupported),
        }
    }

    fn ask(&mut self, event: Event) -> Result<(), RejectReason> {
        let action = self.controller.on(event);
        self.tidy();
        match action {
            Action::Refuse => Err(RejectReason::State),
            _ => Ok(()),
        }
    }
}

impl From<SetError> for RejectReason {
    fn from(error: SetError) -> Self {
        match error {
            SetError::Armed => Self::State,
            SetError::Setting(_) => Self::Value,
        }
    }
}

fn checked(pose: Pose<f32>) -> Result<Pose<f32>, RejectReason> {
    check_goal(&pose).map_err(|_| RejectReason::Value)?;
    Ok(pose)
}
