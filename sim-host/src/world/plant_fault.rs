//! Faults that can be put in and taken out while a world runs.

use super::actuation::Side;
use controller_core::hal::ErrorKind;

/// A fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlantFault {
    /// The counter of an encoder does not move.
    EncoderStuck(Side),
    /// The counter runs backward: two wires swapped.
    EncoderReversed(Side),
    /// Reading the encoders fails.
    EncoderFails,
    /// No pose arrives any more.
    PoseSilent,
    /// Poses taken from now on are off by this, in the world's frame.
    PoseJump {
        /// Off in x \[m\].
        dx: f64,
        /// Off in y \[m\].
        dy: f64,
        /// Off in the heading \[rad\].
        dtheta: f64,
    },
    /// Poses taken from now on are NaN.
    PoseNan,
    /// The drive does not answer: commands are lost, wheels keep the last one or coast.
    DriveFails {
        /// Coast.
        coast: bool,
    },
    /// A driver reports too much current, and something draws it from the battery.
    OverCurrent {
        /// Which driver.
        side: Side,
        /// How much more than the motor takes \[A\].
        amps: f64,
    },
    /// The battery gives this without load, whatever it should \[V\].
    BatterySag {
        /// Volts.
        volts: f64,
    },
    /// A wheel does not turn.
    WheelBlocked(Side),
    /// A wheel has no more than this grip.
    WheelOnIce {
        /// Which wheel.
        side: Side,
        /// Grip.
        mu: f64,
    },
    /// The gyro says the same for ever.
    GyroStuck,
    /// No reading arrives any more.
    GyroSilent,
    /// Rates taken from now on are this many times the true ones: −1 for one that is mounted upside down.
    GyroScale {
        /// Factor.
        factor: f64,
    },
    /// Rates taken from now on are off by this \[rad/s\].
    GyroBias {
        /// Off.
        rad_s: f64,
    },
    /// Rates taken from now on are NaN.
    GyroNan,
    /// The next tick is longer by this \[µs\]; it heals itself.
    LateTick {
        /// Microseconds.
        us: u32,
    },
}

/// The faults that there are now, ready to be asked for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlantFaults {
    pub encoder_stuck: [bool; 2],
    pub encoder_reversed: [bool; 2],
    pub encoder_fails: bool,
    pub pose_silent: bool,
    pub pose_jump: [f64; 3],
    pub pose_nan: bool,
    /// Whether it coasts, if the drive fails.
    pub drive_fails: Option<bool>,
    pub over_current_a: [f64; 2],
    pub sag_v: Option<f64>,
    pub blocked: [bool; 2],
    pub ice: [Option<f64>; 2],
    pub late_us: u32,
    pub gyro_stuck: bool,
    pub gyro_silent: bool,
    pub gyro_scale: Option<f64>,
    pub gyro_bias: f64,
    pub gyro_nan: bool,
}

impl PlantFaults {
    /// Puts a fault in, or takes out the one of its kind and side.
    pub fn set(&mut self, fault: PlantFault, there: bool) {
        let amount = |value: f64| if there { value } else { 0.0 };
        match fault {
            PlantFault::EncoderStuck(side) => self.encoder_stuck[side.index()] = there,
            PlantFault::EncoderReversed(side) => self.encoder_reversed[side.index()] = there,
            PlantFault::EncoderFails => self.encoder_fails = there,
            PlantFault::PoseSilent => self.pose_silent = there,
            PlantFault::PoseJump { dx, dy, dtheta } => {
                self.pose_jump = [amount(dx), amount(dy), amount(dtheta)];
            }
            PlantFault::PoseNan => self.pose_nan = there,
            PlantFault::DriveFails { coast } => self.drive_fails = there.then_some(coast),
            PlantFault::OverCurrent { side, amps } => {
                self.over_current_a[side.index()] = amount(amps);
            }
            PlantFault::BatterySag { volts } => self.sag_v = there.then_some(volts),
            PlantFault::WheelBlocked(side) => self.blocked[side.index()] = there,
            PlantFault::WheelOnIce { side, mu } => self.ice[side.index()] = there.then_some(mu),
            PlantFault::GyroStuck => self.gyro_stuck = there,
            PlantFault::GyroSilent => self.gyro_silent = there,
            PlantFault::GyroScale { factor } => self.gyro_scale = there.then_some(factor),
            PlantFault::GyroBias { rad_s } => self.gyro_bias = amount(rad_s),
            PlantFault::GyroNan => self.gyro_nan = there,
            PlantFault::LateTick { us } => self.late_us = if there { us } else { 0 },
        }
    }

    /// What a driver would answer.
    pub fn drive_answer(&self) -> Result<(), ErrorKind> {
        if self.drive_fails.is_some() {
            Err(ErrorKind::Bus)
        } else if self.over_current_a != [0.0; 2] {
            Err(ErrorKind::OverCurrent)
        } else {
            Ok(())
        }
    }
}
