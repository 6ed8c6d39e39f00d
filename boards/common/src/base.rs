//! The timer interrupt's half: from encoders to motors.

use core::fmt::{self, Display, Formatter};

use controller_core::base::Sensed;
use controller_core::hal::{Clock, Error as _, NoGyro, WheelDrive, WheelEncoders, YawGyro};
use controller_core::types::Pose;
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;
use firmware_demo::control::ControlTask;
use firmware_demo::control_server::{ControlServer, Queues};
use firmware_demo::drive::{Bridges, MotorPair, MotorSide};
use firmware_demo::storage::{Memory, NoMemory};

use crate::line::Line;
use crate::supply::{NoSupply, Supply};
use crate::{config, robot};

/// What a board is made of.
pub struct Parts<P, D, N, E, C, M = NoMemory, G = NoGyro, S = NoSupply> {
    /// PWM and direction of the right motor.
    pub right: MotorSide<P, D>,
    /// PWM and direction of the left motor.
    pub left: MotorSide<P, D>,
    /// High switches the bridges on, low lets the wheels coast; a resistor holds it low from reset on.
    pub enable: N,
    /// Both encoders.
    pub encoders: E,
    /// A gyro, or [`NoGyro`].
    pub gyro: G,
    /// What measures the motor supply, or [`NoSupply`]: then torques are worked out with the nominal one, and an empty battery
    /// is not found.
    pub supply: S,
    /// Microseconds.
    pub clock: C,
    /// What keeps parameters while the power is off, its room made: nothing that takes longer than a tick may be left to do.
    pub memory: M,
}

/// Why there is no robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartError {
    /// A value of the [`robot`] is out of its range, or it has no motors.
    Config,
    /// The motor outputs cannot be made safe.
    Motors,
    /// The encoders do not answer.
    Encoders,
}

impl Display for StartError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Config => "a value of the configuration is out of its range",
            Self::Motors => "the motor outputs cannot be made safe",
            Self::Encoders => "the encoders do not answer",
        })
    }
}

impl core::error::Error for StartError {}

/// Everything that happens once a tick.
pub struct BoardBase<'queue, P, D, N, E, C, M = NoMemory, G = NoGyro, S = NoSupply> {
    server: ControlServer<'queue, MotorPair<P, D, N>, M>,
    encoders: E,
    gyro: G,
    supply: S,
    clock: C,
}

/// The two halves of a board: for the timer's interrupt, and for the background.
pub type Halves<'queue, P, D, N, E, C, M = NoMemory, G = NoGyro, S = NoSupply> =
    (BoardBase<'queue, P, D, N, E, C, M, G, S>, Line<'queue>);

/// Makes the outputs safe and puts a robot together from its parts.
///
/// # Errors
///
/// [`StartError`]; the outputs are then as safe as they could be made.
// Every parameter is a part of the board.
#[allow(clippy::type_complexity)]
pub fn start<'queue, P, D, N, E, C, M, G, S>(
    parts: Parts<P, D, N, E, C, M, G, S>,
    queues: &'queue mut Queues,
) -> Result<Halves<'queue, P, D, N, E, C, M, G, S>, StartError>
where
    P: SetDutyCycle,
    D: OutputPin,
    N: OutputPin,
    E: WheelEncoders,
    C: Clock,
    M: Memory,
    G: YawGyro,
    S: Supply,
{
    let Parts {
        right,
        left,
        mut enable,
        mut encoders,
        gyro,
        supply,
        clock,
        memory,
    } = parts;
    enable.set_low().map_err(|_| StartError::Motors)?;
    let motor = robot::BASE.driver.motor().ok_or(StartError::Config)?;
    let motor = motor.validate().map_err(|_| StartError::Config)?;
    let bridges = Bridges {
        off_phase: config::OFF_PHASE,
        enable: Some(enable),
    };
    let mut motors = MotorPair::new(right, left, bridges, motor);
    motors.release().map_err(|_| StartError::Motors)?;
    encoders.counts().map_err(|_| StartError::Encoders)?;
    let (references, ends, receiver) = queues.split(config::DECIMATE);
    let task = ControlTask::new(motors, references, robot::BASE, Pose::default())
        .map_err(|_| StartError::Config)?;
    let base = BoardBase {
        server: ControlServer::with_memory(task, ends, memory),
        encoders,
        gyro,
        supply,
        clock,
    };
    Ok((base, Line::new(receiver)))
}

impl<'queue, P, D, N, E, C, M, G, S> BoardBase<'queue, P, D, N, E, C, M, G, S>
where
    P: SetDutyCycle,
    D: OutputPin,
    N: OutputPin,
    E: WheelEncoders,
    C: Clock,
    M: Memory,
    G: YawGyro,
    S: Supply,
{
    /// Control task and line, to look at.
    pub const fn server(&self) -> &ControlServer<'queue, MotorPair<P, D, N>, M> {
        &self.server
    }

    /// One tick: reads, computes, drives. The bridges are on only while a torque is applied to the wheels, if one of 0 as when armed, or
    /// they are braked: enable is the motors' own.
    pub fn tick(&mut self) {
        let now_us = self.clock.now_us();
        let sensed = Sensed {
            counts: self.encoders.counts().map_err(|error| error.kind()),
            fix: None,
            // One that does not answer is silent: the base finds that by itself.
            gyro: self.gyro.reading().unwrap_or(None),
            supply_v: self.supply.volts(),
            // No board measures them yet.
            currents: None,
            driver: Ok(()),
        };
        self.server.tick(now_us, &sensed);
    }
}
