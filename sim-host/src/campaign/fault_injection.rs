//! What goes wrong in a run.

use super::host::Manner;
use super::line::LineFault;
use super::random::Random;
use crate::mission::BaseSpec;
use crate::world::{LONGEST_TICK_US, PlantFault, Side, World};
use serde::{Deserialize, Serialize};

/// For jitter and lateness of a plan's ticks \[µs\]: 0.2 ms, and 5 σ of the lateness, 0.5 ms e^(5 · 0.5).
const ROOM_US: f64 = 200.0 + 6_092.0;

/// Kinds of trouble: every [`PlantFault`] of a world, and what host and links can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum FaultInjectionKind {
    /// Nothing at all: what the others are compared with.
    Nothing,
    /// [`PlantFault::EncoderStuck`].
    EncoderStuck,
    /// [`PlantFault::EncoderReversed`].
    EncoderReversed,
    /// [`PlantFault::EncoderFails`].
    EncoderFails,
    /// [`PlantFault::PoseSilent`].
    PoseSilent,
    /// [`PlantFault::PoseJump`].
    PoseJump,
    /// [`PlantFault::PoseNan`].
    PoseNan,
    /// External poses whose age is not a number.
    FixAgeNan,
    /// [`PlantFault::DriveFails`], wheels coast.
    DriveCoasts,
    /// [`PlantFault::DriveFails`], wheels keep the last command.
    DriveHolds,
    /// [`PlantFault::OverCurrent`].
    OverCurrent,
    /// [`PlantFault::BatterySag`].
    BatterySag,
    /// [`PlantFault::WheelBlocked`].
    WheelBlocked,
    /// [`PlantFault::WheelOnIce`].
    WheelOnIce,
    /// [`PlantFault::LateTick`], once.
    LateTick,
    /// [`PlantFault::LateTick`] in every tick.
    LateTicks,
    /// The host says nothing any more.
    HostSilent,
    /// One goal or sample that is not a number.
    OrderNan,
    /// The button, as the host sends it.
    EmergencyStop,
    /// Frames that nobody needs, more than a tick can take.
    LineFull,
    /// Bytes on the line are changed, lost, or more than were sent.
    LineDamaged,
    /// Bytes are on the line for longer.
    LineDelayed,
    /// [`PlantFault::GyroSilent`].
    GyroSilent,
    /// [`PlantFault::GyroNan`].
    GyroNan,
    /// [`PlantFault::GyroStuck`].
    GyroStuck,
    /// [`PlantFault::GyroScale`] of −1.
    GyroReversed,
    /// [`PlantFault::GyroScale`].
    GyroScale,
    /// [`PlantFault::GyroBias`].
    GyroBias,
}

impl FaultInjectionKind {
    /// Of the line between host and base.
    pub const fn is_line(self) -> bool {
        matches!(self, Self::LineFull | Self::LineDamaged | Self::LineDelayed)
    }

    /// Of the poses from outside.
    pub const fn is_of_poses(self) -> bool {
        matches!(
            self,
            Self::PoseSilent | Self::PoseJump | Self::PoseNan | Self::FixAgeNan
        )
    }

    /// All of a base without a gyro.
    pub const ALL: [Self; 22] = [
        Self::Nothing,
        Self::EncoderStuck,
        Self::EncoderReversed,
        Self::EncoderFails,
        Self::PoseSilent,
        Self::PoseJump,
        Self::PoseNan,
        Self::FixAgeNan,
        Self::DriveCoasts,
        Self::DriveHolds,
        Self::OverCurrent,
        Self::BatterySag,
        Self::WheelBlocked,
        Self::WheelOnIce,
        Self::LateTick,
        Self::LateTicks,
        Self::HostSilent,
        Self::OrderNan,
        Self::EmergencyStop,
        Self::LineFull,
        Self::LineDamaged,
        Self::LineDelayed,
    ];

    /// What comes to them on a base with one.
    pub const GYRO: [Self; 6] = [
        Self::GyroSilent,
        Self::GyroNan,
        Self::GyroStuck,
        Self::GyroReversed,
        Self::GyroScale,
        Self::GyroBias,
    ];

    /// For tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::EncoderStuck => "encoder stuck",
            Self::EncoderReversed => "encoder reversed",
            Self::EncoderFails => "encoders fail",
            Self::PoseSilent => "poses missing",
            Self::PoseJump => "poses jump",
            Self::PoseNan => "poses NaN",
            Self::FixAgeNan => "pose age NaN",
            Self::DriveCoasts => "driver fails, coasts",
            Self::DriveHolds => "driver fails, holds",
            Self::OverCurrent => "driver over-current",
            Self::BatterySag => "battery sags",
            Self::WheelBlocked => "wheel blocked",
            Self::WheelOnIce => "wheel on ice",
            Self::LateTick => "one late tick",
            Self::LateTicks => "late ticks",
            Self::HostSilent => "host silent",
            Self::OrderNan => "order NaN",
            Self::EmergencyStop => "emergency stop",
            Self::LineFull => "line full",
            Self::LineDamaged => "line damaged",
            Self::LineDelayed => "line delayed",
            Self::GyroSilent => "gyro silent",
            Self::GyroNan => "gyro NaN",
            Self::GyroStuck => "gyro stuck",
            Self::GyroReversed => "gyro reversed",
            Self::GyroScale => "gyro scale",
            Self::GyroBias => "gyro bias",
        }
    }

    /// One of this kind on a base.
    pub(super) fn draw(self, base: &BaseSpec, random: &mut Random) -> FaultInjection {
        let side = if random.chance(0.5) {
            Side::Right
        } else {
            Side::Left
        };
        let period_us = base
            .hardware
            .map_or(10_000.0, |hardware| 1.0e6 * hardware.period_s);
        // No tick is longer than the plant takes, by what a plan's jitter and lateness may add to it.
        let late = |periods: f64| {
            let most = f64::from(LONGEST_TICK_US) - ROOM_US - period_us;
            (period_us * periods).min(most) as u32
        };
        let what = match self {
            Self::Nothing => What::Nothing,
            Self::EncoderStuck => What::PlantFault(PlantFault::EncoderStuck(side)),
            Self::EncoderReversed => What::PlantFault(PlantFault::EncoderReversed(side)),
            Self::EncoderFails => What::PlantFault(PlantFault::EncoderFails),
            Self::PoseSilent => What::PlantFault(PlantFault::PoseSilent),
            // From what fusion averages away to what it has to believe after a while.
            Self::PoseJump => What::PlantFault(PlantFault::PoseJump {
                dx: random.between(-0.5, 0.5),
                dy: random.between(-0.5, 0.5),
                dtheta: random.between(-0.5, 0.5),
            }),
            Self::PoseNan => What::PlantFault(PlantFault::PoseNan),
            Self::FixAgeNan => What::FixAgeNan,
            Self::DriveCoasts => What::PlantFault(PlantFault::DriveFails { coast: true }),
            Self::DriveHolds => What::PlantFault(PlantFault::DriveFails { coast: false }),
            Self::OverCurrent => What::PlantFault(PlantFault::OverCurrent {
                side,
                amps: random.between(1.0, 20.0),
            }),
            // Always below the 70 % from which on it counts as low.
            Self::BatterySag => What::PlantFault(PlantFault::BatterySag {
                volts: base.hardware.map_or(12.0, |h| h.battery.nominal_v)
                    * random.between(0.3, 0.65),
            }),
            Self::WheelBlocked => What::PlantFault(PlantFault::WheelBlocked(side)),
            Self::WheelOnIce => What::PlantFault(PlantFault::WheelOnIce {
                side,
                mu: random.between(0.05, 0.2),
            }),
            Self::LateTick => What::LateOnce(late(random.between(1.0, 19.0))),
            Self::LateTicks => What::Late(late(random.between(0.7, 3.0))),
            Self::HostSilent => What::HostSilent,
            Self::OrderNan => What::OrderNan {
                park: random.chance(0.5),
            },
            Self::EmergencyStop => What::EmergencyStop,
            // From one to eight times what a tick takes.
            Self::LineFull => What::Line(Manner {
                flood: 1 + random.below(64),
                ..Manner::default()
            }),
            // From a frame of 12 bytes in a hundred to a half of them.
            Self::LineDamaged => What::Line(Manner {
                line: LineFault {
                    damaged: 10.0_f64.powf(random.between(-3.0, -1.25)),
                    delay_us: 0,
                },
                ..Manner::default()
            }),
            // As radio modules do; half of it is the half of the base's patience with its host.
            Self::LineDelayed => What::Line(Manner {
                line: LineFault {
                    damaged: 0.0,
                    delay_us: random.between(5.0e3, 6.0e4) as u64,
                },
                ..Manner::default()
            }),
            Self::GyroSilent => What::PlantFault(PlantFault::GyroSilent),
            Self::GyroNan => What::PlantFault(PlantFault::GyroNan),
            Self::GyroStuck => What::PlantFault(PlantFault::GyroStuck),
            Self::GyroReversed => What::PlantFault(PlantFault::GyroScale { factor: -1.0 }),
            // A register that says another range: half, double.
            Self::GyroScale => What::PlantFault(PlantFault::GyroScale {
                factor: if random.chance(0.5) { 0.5 } else { 2.0 },
            }),
            // From ten times what a good one has to what a poor one has.
            Self::GyroBias => What::PlantFault(PlantFault::GyroBias {
                rad_s: random.between(0.1, 0.5) * if random.chance(0.5) { 1.0 } else { -1.0 },
            }),
        };
        FaultInjection { kind: self, what }
    }
}

/// Trouble with its amount.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultInjection {
    /// Kind.
    pub kind: FaultInjectionKind,
    pub(super) what: What,
}

/// How it is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum What {
    Nothing,
    PlantFault(PlantFault),
    FixAgeNan,
    /// \[µs\].
    LateOnce(u32),
    Late(u32),
    HostSilent,
    OrderNan {
        park: bool,
    },
    EmergencyStop,
    Line(Manner),
}

impl FaultInjection {
    /// In place at the beginning of every tick.
    pub(super) fn apply(&self, world: &mut World, first: bool) {
        match self.what {
            What::PlantFault(fault) if first => world.inject(fault),
            What::LateOnce(us) if first => world.inject(PlantFault::LateTick { us }),
            What::Late(us) => world.inject(PlantFault::LateTick { us }),
            _ => {}
        }
    }

    /// Over.
    pub(super) fn heal(&self, world: &mut World) {
        if let What::PlantFault(fault) = self.what {
            world.heal(fault);
        }
    }

    /// What it adds to a host's manner.
    pub(super) fn hinder(&self, manner: &mut Manner) {
        match self.what {
            What::HostSilent => manner.silent = true,
            What::FixAgeNan => manner.bad_age = true,
            What::Line(other) => {
                manner.flood = manner.flood.max(other.flood);
                let (line, other) = (&mut manner.line, &other.line);
                line.damaged = line.damaged.max(other.damaged);
                line.delay_us = line.delay_us.max(other.delay_us);
            }
            _ => {}
        }
    }

    /// What it adds to a tick \[s\].
    pub(super) fn late_s(&self) -> f64 {
        match self.what {
            What::LateOnce(us) | What::Late(us) => 1.0e-6 * f64::from(us),
            _ => 0.0,
        }
    }

    /// Grip that it leaves a wheel.
    pub(super) fn ice(&self) -> Option<f64> {
        match self.what {
            What::PlantFault(PlantFault::WheelOnIce { mu, .. }) => Some(mu),
            _ => None,
        }
    }
}
