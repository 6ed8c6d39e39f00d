//! What goes into a tick and what comes out of it.

use crate::gyro::GyroReading;
use crate::hal::{ErrorKind, Observed, WheelCounts};
use crate::localiser::Fix;
use crate::reference::Reference;
use crate::safety::Currents;
use crate::types::{Pose, Twist, WheelSpeeds, WheelTorques};

/// What the host, or a trajectory in flash, wants of this tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Order<T = f32> {
    /// Nothing new: a base that parks goes on parking; one that follows goes on along its last
    /// reference, as that moved, and one that drives by velocity with its last order, until the command is stale: after
    /// [`DetectorParams::command`](crate::safety::DetectorParams), 0.1 s. Where nobody calls
    /// [`watch_link`](super::BaseController::watch_link) that is so in every state, and a goal is to be repeated as well.
    #[default]
    None,
    /// Follow this sample, of the present instant.
    Follow(Reference<T>),
    /// Go to this pose and stay; repeated in every tick, or at least as often as a command becomes stale.
    Park(Pose<T>),
    /// Drive with this speed and turn rate until the next order, which is due within the same time as the next sample
    /// of a reference ([`DetectorParams::command`](crate::safety::DetectorParams)).
    Drive {
        /// Ordered \[m/s, rad/s\]; see [`check_order`](crate::motion::check_order).
        twist: Twist<T>,
        /// Keep the heading; see [`Task::Drive`](crate::motion::Task::Drive).
        hold_heading: bool,
    },
}

/// What the base measured since the last tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sensed<T = f32> {
    /// Both encoders, or why they could not be read. Counts that a wheel would have to turn four times as fast for as the largest rim speed are no reading.
    pub counts: Result<WheelCounts, ErrorKind>,
    /// An external pose, in the ticks in which one arrived.
    pub fix: Option<Fix<T>>,
    /// What the gyro says, in the ticks in which a reading arrived.
    pub gyro: Option<GyroReading<T>>,
    /// Supply of the motors \[V\], where it is measured.
    pub supply_v: Option<T>,
    /// Currents of the motors \[A\], where they are measured.
    pub currents: Option<Currents<T>>,
    /// What the wheel driver answered to the last command.
    pub driver: Result<(), ErrorKind>,
}

impl<T> Sensed<T> {
    /// Encoders, and nothing else.
    pub const fn of_counts(counts: WheelCounts) -> Self {
        Self {
            counts: Ok(counts),
            fix: None,
            gyro: None,
            supply_v: None,
            currents: None,
            driver: Ok(()),
        }
    }
}

/// What the wheels are to do until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WheelAction<T = f32> {
    /// No torque, free to coast.
    #[default]
    Release,
    /// Windings shorted.
    Brake,
    /// These torques.
    Drive(DriveCommand<T>),
}

impl<T: Copy> WheelAction<T> {
    /// The torques; `None` where the wheels are braked or released.
    pub const fn torques(&self) -> Option<WheelTorques<T>> {
        match self {
            Self::Drive(drive) => Some(drive.torques),
            Self::Release | Self::Brake => None,
        }
    }
}

/// Torques, and what a motor driver needs beside them. A driver that closes its own speed loop takes `desired` and nothing else.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveCommand<T = f32> {
    /// Within ± `wheel_torque_nm` \[N m\]. With [`DriverParams::Speeds`](crate::motor::DriverParams::Speeds) nobody knows what the drivers exert: what
    /// accelerates the base as it is commanded, without friction.
    pub torques: WheelTorques<T>,
    /// Speeds that are commanded \[rad/s\], for the compensation of friction; with `DriverParams::Speeds` those that the drivers are to hold, led by
    /// their lag ([`SpeedOutput`](crate::motor::SpeedOutput)).
    pub desired: WheelSpeeds<T>,
    /// Speeds in the middle of the tick, for the back-EMF \[rad/s\]: [`Odometry::back_emf_speeds`](crate::odometry::Odometry::back_emf_speeds), and half a tick of the commanded acceleration.
    pub speeds: WheelSpeeds<T>,
    /// Friction beyond the Coulomb part of the parameters, as the base has found it \[N m\]. Only while it creeps: driving by velocity, and beside a goal with no manoeuvre under way.
    pub beyond_coulomb: Option<WheelTorques<T>>,
}

impl DriveCommand {
    /// What a motor driver needs beside these torques; `supply_v` is that at its bridges \[V\], where something measures it.
    #[inline]
    #[must_use]
    pub fn observed(&self, supply_v: Option<f32>) -> Observed {
        Observed {
            speeds: self.speeds,
            desired: self.desired,
            beyond_coulomb: self.beyond_coulomb,
            supply_v: supply_v.unwrap_or(f32::NAN),
        }
    }
}
