//! A run, drawn from its seed.

use super::fault_injection::{FaultInjection, FaultInjectionKind};
use super::path::{Path, VelocityOrders};
use super::random::Random;
use crate::job::RobotFile;
use crate::mission::BaseSpec;
use crate::scenario::{BASES, BuiltInBase, ScenarioError};
use crate::world::WorldSetup;
use crate::world::{BodyKeys, FloorParams, FrictionParams, NoiseParams, TickParams, WorldKeys};
use controller_core::safety::supervisor::State;
use controller_core::types::Pose;
use serde::{Deserialize, Serialize};

/// The state in which trouble strikes; the base is driven there by commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[allow(missing_docs)] // As `State`.
pub enum Target {
    Idle,
    Armed,
    Tracking,
    Parking,
    Parked,
    Stopping,
    Braking,
    Stopped,
    Fault,
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Idle,
        Self::Armed,
        Self::Tracking,
        Self::Parking,
        Self::Parked,
        Self::Stopping,
        Self::Braking,
        Self::Stopped,
        Self::Fault,
    ];

    /// Of a state, whatever its end.
    pub const fn of(state: State) -> Self {
        match state {
            State::Idle => Self::Idle,
            State::Armed => Self::Armed,
            State::Tracking => Self::Tracking,
            State::Parking => Self::Parking,
            State::Parked => Self::Parked,
            State::Stopping(_) => Self::Stopping,
            State::Braking(_) => Self::Braking,
            State::Stopped => Self::Stopped,
            State::Fault => Self::Fault,
        }
    }

    /// For tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Armed => "armed",
            Self::Tracking => "tracking",
            Self::Parking => "parking",
            Self::Parked => "parked",
            Self::Stopping => "stopping",
            Self::Braking => "braking",
            Self::Stopped => "stopped",
            Self::Fault => "fault",
        }
    }

    /// Longest time from reaching the state to the trouble \[s\]. Stops are over soon: the slowest
    /// speeds need 0.4 s for a controlled stop, and any braking lasts for the dwell of rest, 0.1 s.
    const fn longest_wait_s(self) -> f64 {
        match self {
            Self::Tracking => 4.0,
            Self::Parking => 1.0,
            Self::Stopping => 0.25,
            Self::Braking => 0.08,
            Self::Idle | Self::Armed | Self::Parked | Self::Stopped | Self::Fault => 1.0,
        }
    }

    /// It is a stop on the way.
    pub(super) const fn is_a_stop(self) -> bool {
        matches!(self, Self::Stopping | Self::Braking)
    }

    /// Nothing moves and nothing is asked to.
    pub(super) const fn waits(self) -> bool {
        matches!(self, Self::Idle | Self::Armed | Self::Stopped | Self::Fault)
    }
}

/// Everything about a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Seed of the campaign.
    pub seed: u64,
    /// Number in it.
    pub run: u64,
    /// Which of [`Bases::all`].
    pub base: usize,
    /// It has a gyro.
    pub gyro: bool,
    /// In what state.
    pub target: Target,
    /// What.
    pub injection: FaultInjection,
    /// Something else, so long after a stop began \[s\].
    pub second: Option<(f64, FaultInjection)>,
    /// When the trouble is over, after it began \[s\]; at the end if at all.
    pub heal_s: Option<f64>,
    /// After the end everything is mended, the base reset, armed and given a new goal.
    pub again: bool,
    pub(super) wait_s: f64,
    /// Of following before a stop is commanded, and after the trouble before parking \[s\].
    pub(super) follow_s: (f64, f64),
    /// A base that waits is armed and given a goal while the trouble lasts.
    pub(super) wake: bool,
    /// On a line in trouble: the host stops the base so long after the trouble began \[s\], by the button if so.
    pub(super) stop: Option<(f64, bool)>,
    pub(super) path: Path,
    /// The host drives by velocity instead of sending a trajectory.
    pub(super) orders: Option<VelocityOrders>,
    pub(super) goal: Pose<f64>,
    /// The true plant.
    pub setup: WorldSetup,
}

/// Bases, read once for all runs.
#[derive(Clone, Debug)]
pub struct Bases {
    all: Vec<BaseSpec>,
    /// Of the robot of a file, which is then the only one.
    robot: Option<String>,
    kinds: Vec<FaultInjectionKind>,
}

impl Bases {
    /// Those built in.
    ///
    /// # Errors
    /// As [`BaseSpec::parse`]; a test reads them all.
    pub fn built_in() -> Result<Self, ScenarioError> {
        Self::all_with(BuiltInBase::base, &[])
    }

    /// Those built in, each with [`GYRO`](crate::scenario::GYRO), and what can go wrong with it.
    ///
    /// # Errors
    /// As [`BaseSpec::parse`]; a test reads them all.
    pub fn with_gyro() -> Result<Self, ScenarioError> {
        Self::all_with(BuiltInBase::with_gyro, &FaultInjectionKind::GYRO)
    }

    /// Those built in, each with [`SPEED_DRIVER`](crate::scenario::SPEED_DRIVER).
    ///
    /// # Errors
    /// As [`BaseSpec::parse`]; a test reads them all.
    pub fn with_speed_driver() -> Result<Self, ScenarioError> {
        Self::all_with(BuiltInBase::with_speed_driver, &[])
    }

    /// The robot of a file alone, with what can go wrong with what it has: poses and a gyro only if its file has them.
    pub fn of_robot(robot: &RobotFile) -> Self {
        let hardware = robot.base.hardware;
        let poses = hardware.is_some_and(|hardware| hardware.pose_source.is_some());
        let gyro = hardware.is_some_and(|hardware| hardware.gyro.is_some());
        let all = FaultInjectionKind::ALL.into_iter();
        let has = all.filter(|kind| poses || !kind.is_of_poses());
        let also = FaultInjectionKind::GYRO.into_iter().filter(|_| gyro);
        Self {
            all: vec![robot.base.clone()],
            robot: Some(robot.name.clone()),
            kinds: has.chain(also).collect(),
        }
    }

    /// Those built in, as `base` reads them, and what can go wrong with them beside what can with all.
    fn all_with(
        base: fn(&BuiltInBase) -> Result<BaseSpec, ScenarioError>,
        also: &[FaultInjectionKind],
    ) -> Result<Self, ScenarioError> {
        Ok(Self {
            all: BASES.iter().map(base).collect::<Result<_, _>>()?,
            robot: None,
            kinds: [&FaultInjectionKind::ALL[..], also].concat(),
        })
    }

    /// Kinds of trouble that they can have.
    pub fn kinds(&self) -> &[FaultInjectionKind] {
        &self.kinds
    }

    /// The trouble of run `run`, whatever the seed.
    pub fn trouble(&self, run: u64) -> FaultInjectionKind {
        let (states, kinds) = (Target::ALL.len() as u64, self.kinds.len() as u64);
        self.kinds[(run / states % kinds) as usize]
    }

    /// All of them.
    pub fn all(&self) -> &[BaseSpec] {
        &self.all
    }

    /// Name of the robot of a file, if they are that alone.
    pub fn robot(&self) -> Option<&str> {
        self.robot.as_deref()
    }

    /// Of a plan.
    pub fn of(&self, plan: &Plan) -> &BaseSpec {
        &self.all[plan.base]
    }
}

impl Plan {
    /// Run `run` of the campaign of `seed`. Runs go through every state with every kind of trouble
    /// on every base in turn; all else is random.
    pub fn draw(bases: &Bases, seed: u64, run: u64) -> Self {
        let random = &mut Random::new(seed, run);
        let (states, kinds) = (Target::ALL.len() as u64, bases.kinds.len() as u64);
        let target = Target::ALL[(run % states) as usize];
        let kind = bases.trouble(run);
        let index = (run / (states * kinds) % bases.all.len() as u64) as usize;
        let base = &bases.all[index];
        let injection = kind.draw(base, random);
        let second = random.chance(0.2).then(|| {
            let other = bases.kinds[random.below(bases.kinds.len())];
            (random.between(0.0, 0.3), other.draw(base, random))
        });
        let limits = &base.limits;
        let speed = limits.speed * random.between(0.35, 0.8);
        let curvature = if random.chance(0.4) {
            0.0
        } else {
            0.5 * limits.turn_rate / speed * random.between(-1.0, 1.0)
        };
        let reach = limits.speed * random.between(0.9, 1.6);
        let bearing = random.between(-0.6, 0.6);
        let again = random.chance(0.4);
        Self {
            seed,
            run,
            base: index,
            gyro: base
                .hardware
                .is_some_and(|hardware| hardware.gyro.is_some()),
            target,
            injection,
            second,
            // What holds torque has no end but the watchdog of its driver.
            heal_s: if kind == FaultInjectionKind::DriveHolds {
                Some(random.between(0.05, 0.5))
            } else {
                random.chance(0.25).then(|| random.between(0.02, 2.0))
            },
            again,
            wait_s: random.between(0.0, target.longest_wait_s()),
            follow_s: (random.between(1.5, 3.0), random.between(1.0, 4.0)),
            wake: random.chance(0.5),
            stop: (kind.is_line() && random.chance(0.5))
                .then(|| (random.between(0.0, 1.5), random.chance(0.5))),
            path: Path {
                speed,
                accel: 0.6 * limits.accel,
                curvature,
            },
            goal: Pose::new(
                reach * bearing.cos(),
                reach * bearing.sin(),
                random.between(-0.8, 0.8),
            ),
            setup: WorldSetup {
                world: world(base, random),
                seed: random.word(),
            },
            orders: random
                .chance(0.5)
                .then(|| VelocityOrders::draw(limits, target.is_a_stop(), random)),
        }
    }
}

/// Mild imperfections: what is left after a robot was identified.
fn world(base: &BaseSpec, random: &mut Random) -> WorldKeys {
    let mut keys = base.hardware.map_or_else(WorldKeys::default, |h| h.world());
    keys.body = BodyKeys {
        // A payload of a tenth.
        mass_factor: random.between(0.9, 1.1),
        inertia_factor: random.between(0.9, 1.1),
        // Wear within calibration.
        radius_right_factor: random.between(0.997, 1.003),
        radius_left_factor: random.between(0.997, 1.003),
        ..BodyKeys::default()
    };
    // Grease, cold and warm.
    let worn = random.between(0.8, 1.2);
    keys.friction = FrictionParams {
        static_nm: keys.friction.static_nm * worn,
        coulomb_nm: keys.friction.coulomb_nm * worn,
        viscous_nm_s: keys.friction.viscous_nm_s * worn,
        rolling: random.between(0.0, 0.01),
    };
    keys.floor = FloorParams {
        // Rubber on a clean floor.
        mu: random.between(0.7, 1.0),
        ..FloorParams::default()
    };
    keys.battery.open_circuit_v = Some(keys.battery.nominal_v * random.between(0.95, 1.05));
    keys.noise = NoiseParams {
        supply_v: 0.01,
        current_a: 0.05,
    };
    keys.tick = TickParams {
        jitter_us: random.between(0.0, 200.0) as u32,
        late_probability: 0.01,
        late_median_us: 500.0,
        late_spread: 0.5,
    };
    keys
}
