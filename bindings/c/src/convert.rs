//! Between the header's structs and the core's types.

use core::mem::MaybeUninit;

use controller_core::base::{self, WheelAction};
use controller_core::gyro::GyroReading;
use controller_core::hal::{ErrorKind, WheelCounts};
use controller_core::localiser::Fix;
use controller_core::reference::Reference;
use controller_core::safety::Currents;
use controller_core::safety::supervisor::{Cause, State, Then};
use controller_core::types::{Accel, Pose, Twist, WheelSpeeds, WheelTorques};
use protocol::RobotBlobError;

use crate::abi::{self, Status, action, device, order, sensed};

impl From<&abi::Pose> for Pose<f32> {
    fn from(&abi::Pose { x, y, theta }: &abi::Pose) -> Self {
        Self { x, y, theta }
    }
}

impl From<&abi::Twist> for Twist<f32> {
    fn from(&abi::Twist { v, w }: &abi::Twist) -> Self {
        Self::new(v, w)
    }
}

impl From<&WheelTorques<f32>> for abi::Wheels {
    fn from(&WheelTorques { right, left }: &WheelTorques<f32>) -> Self {
        Self { right, left }
    }
}

impl From<&WheelSpeeds<f32>> for abi::Wheels {
    fn from(&WheelSpeeds { right, left }: &WheelSpeeds<f32>) -> Self {
        Self { right, left }
    }
}

impl From<RobotBlobError> for Status {
    fn from(error: RobotBlobError) -> Self {
        match error {
            RobotBlobError::Magic => Self::RobotMagic,
            RobotBlobError::Length => Self::RobotLength,
            RobotBlobError::Check => Self::RobotCheck,
            RobotBlobError::Version(_) => Self::RobotVersion,
            RobotBlobError::Content => Self::RobotContent,
        }
    }
}

/// A flag of the header: 0 or 1.
pub(crate) const fn flag(value: u32) -> Result<bool, Status> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(Status::BadValue),
    }
}

/// An order, written to where the tick reads it: by value the numbers of all kinds would be copied. Values are the tick's to judge,
/// only kinds are judged here.
#[inline]
pub(crate) fn order<'a>(
    order: &abi::Order,
    to: &'a mut MaybeUninit<base::Order<f32>>,
) -> Result<&'a base::Order<f32>, Status> {
    Ok(match order.kind {
        order::NONE => to.write(base::Order::None),
        order::FOLLOW => follow(order, to),
        order::PARK => to.write(base::Order::Park((&order.pose).into())),
        order::VELOCITY => {
            // Judged first: with a decision between, the twist would be copied number by number.
            let hold_heading = flag(order.hold_heading)?;
            to.write(base::Order::Drive {
                twist: (&order.twist).into(),
                hold_heading,
            })
        }
        _ => return Err(Status::BadValue),
    })
}

/// A sample to follow. Apart, for the compiler would make one piece of the stores of all kinds, with addresses that it works out.
#[inline(never)]
fn follow<'a>(
    order: &abi::Order,
    to: &'a mut MaybeUninit<base::Order<f32>>,
) -> &'a base::Order<f32> {
    let accel = Accel::new(order.accel.v, order.accel.w);
    let reference = Reference::new((&order.pose).into(), (&order.twist).into(), accel);
    to.write(base::Order::Follow(reference.with_left(order.left)))
}

/// What is wrong with a device.
const fn device(status: u32) -> Result<Result<(), ErrorKind>, Status> {
    Ok(Err(match status {
        device::OK => return Ok(Ok(())),
        device::BUS => ErrorKind::Bus,
        device::OVER_CURRENT => ErrorKind::OverCurrent,
        device::UNDER_VOLTAGE => ErrorKind::UnderVoltage,
        device::OUT_OF_RANGE => ErrorKind::OutOfRange,
        device::OTHER => ErrorKind::Other,
        _ => return Err(Status::BadValue),
    }))
}

/// What was sensed, written to where the tick reads it, so that what is not there is not copied. `answer` is the [`device`] code that a driver
/// would have answered the last duties with; it is cleared with what it is told in.
#[inline]
pub(crate) fn sensed(
    sensed: &abi::Sensed,
    answer: &mut u32,
    to: &mut base::Sensed<f32>,
) -> Result<(), Status> {
    let there = |flag| sensed.flags & flag != 0;
    to.counts = Ok(WheelCounts {
        right: sensed.right,
        left: sensed.left,
    });
    if there(sensed::FIX) {
        to.fix = Some(Fix {
            pose: (&sensed.fix).into(),
            age_s: sensed.fix_age_s,
        });
    }
    to.supply_v = there(sensed::SUPPLY).then_some(sensed.supply_v);
    // One look for what most bases have not, for what no flag stands for, and for what is not well.
    let more = sensed.flags & !(sensed::FIX | sensed::SUPPLY);
    let unwell = sensed.encoders | sensed.driver | *answer;
    if more | unwell != 0 {
        let no_rate = there(sensed::GYRO_HEADING) && !there(sensed::GYRO);
        if there(!sensed::KNOWN) || no_rate {
            return Err(Status::BadValue);
        }
        if there(sensed::GYRO) {
            to.gyro = Some(GyroReading {
                rate: sensed.gyro_rate,
                heading: there(sensed::GYRO_HEADING).then_some(sensed.gyro_heading),
                age_s: sensed.gyro_age_s,
            });
        }
        if there(sensed::CURRENTS) {
            to.currents = Some(Currents {
                right: sensed.currents.right,
                left: sensed.currents.left,
            });
        }
        if unwell != device::OK {
            devices(sensed, answer, to)?;
        }
    }
    Ok(())
}

/// What is wrong with encoders and driver.
#[cold]
fn devices(
    sensed: &abi::Sensed,
    answer: &mut u32,
    to: &mut base::Sensed<f32>,
) -> Result<(), Status> {
    let (encoders, driver) = (device(sensed.encoders)?, device(sensed.driver)?);
    if let Err(error) = encoders {
        to.counts = Err(error);
    }
    to.driver = driver.and(device(*answer)?);
    *answer = device::OK;
    Ok(())
}

/// The kind of an action.
pub(crate) const fn kind(action: &WheelAction<f32>) -> u32 {
    match action {
        WheelAction::Release => action::RELEASE,
        WheelAction::Brake => action::BRAKE,
        WheelAction::Drive(_) => action::DRIVE,
    }
}

/// The place in `State::ALL`.
pub(crate) const fn state(state: State) -> u32 {
    match state {
        State::Idle => 0,
        State::Armed => 1,
        State::Tracking => 2,
        State::Parking => 3,
        State::Parked => 4,
        State::Stopping(Then::Stopped) => 5,
        State::Stopping(Then::Fault) => 6,
        State::Braking(Then::Stopped) => 7,
        State::Braking(Then::Fault) => 8,
        State::Stopped => 9,
        State::Fault => 10,
    }
}

/// The cause's code, and that of its fault.
pub(crate) const fn cause(cause: Cause) -> (u32, u32) {
    match cause {
        Cause::PowerOn => (0, 0),
        Cause::Host => (1, 0),
        Cause::References => (2, 0),
        Cause::TrajectoryEnded => (3, 0),
        Cause::Reached => (4, 0),
        Cause::GoalUnreachable => (5, 0),
        Cause::LinkLost => (6, 0),
        Cause::EmergencyStop => (7, 0),
        Cause::Demanded => (8, 0),
        Cause::Fault(fault) => (9, fault.kind().code() as u32),
        // A cause that the header has no number for yet.
        _ => (u32::MAX, 0),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::{Cause, State};
    use crate::names;
    use controller_core::safety::Fault;
    use std::format;
    use std::string::String;

    /// `StoppingFault` in words, which the header has with underlines.
    fn words(name: &str) -> String {
        let words = name.char_indices().map(|(at, c)| match c {
            'A'..='Z' if at > 0 => format!(" {}", c.to_ascii_lowercase()),
            _ => String::from(c.to_ascii_lowercase()),
        });
        words.collect()
    }

    #[test]
    fn codes_have_the_names_of_what_they_stand_for() {
        for cause in [
            Cause::PowerOn,
            Cause::Host,
            Cause::References,
            Cause::TrajectoryEnded,
            Cause::Reached,
            Cause::GoalUnreachable,
            Cause::LinkLost,
            Cause::EmergencyStop,
            Cause::Demanded,
            Cause::Fault(Fault::Stalled),
        ] {
            let (code, _) = super::cause(cause);
            let name = format!("{cause:?}").replace("(Stalled)", "");
            assert_eq!(names::cause(code).to_str(), Ok(words(&name).as_str()));
        }
        for state in State::ALL {
            let name = words(&format!("{state:?}"));
            let name = name
                .replace("( stopped)", "")
                .replace("( fault)", " for a fault");
            let code = super::state(state);
            assert_eq!(names::state(code).to_str(), Ok(name.as_str()));
        }
    }
}
