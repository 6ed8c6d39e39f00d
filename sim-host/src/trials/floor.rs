//! Bad floors that suit a base, drawn by a seed.

use crate::mission::{BaseSpec, OLDEST_POSE};
use crate::world::WorldSetup;
use crate::world::{WorldKeys, presets};
use controller_core::robot::Robot;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};
use std::mem::swap;

/// What of a world is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Condition {
    /// Everything is drawn.
    Drawn,
    /// Mass and inertia at 0.7 of what the controller believes.
    Light,
    /// Both at 1.3.
    Heavy,
    /// Mass 0.7, inertia 1.3: weight at the rim.
    Wide,
    /// Mass 1.3, inertia 0.7: weight in the middle.
    Narrow,
    /// Battery at 80 % of its nominal voltage.
    LowBattery,
}

/// Mass and inertia are drawn, and stand at their corners, this far from what is believed.
const BODY_SPREAD: f64 = 0.3;
/// Battery without load, as a share of its nominal voltage: nearly empty to full.
const BATTERY: (f64, f64) = (0.8, 1.0);
/// A worn bearing in the cold, and one that ran in: factors on the file's friction.
const FRICTION: (f64, f64) = (0.7, 1.3);
/// Dead band of the motors' drivers: a factor on the file's. Dead times and the drops of diodes follow current and temperature.
const DEAD_BAND: (f64, f64) = (0.7, 1.3);
/// Lag of a driver's own speed loop: a factor on the file's, which the base makes up for. With the load a loop is quicker and slower.
const LAG: (f64, f64) = (0.7, 1.3);
/// Age of poses, a factor on the file's.
const LATENCY: (f64, f64) = (1.0, OLDEST_POSE);

impl Condition {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Drawn,
        Self::Light,
        Self::Heavy,
        Self::Wide,
        Self::Narrow,
        Self::LowBattery,
    ];

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Drawn => "all drawn",
            Self::Light => "m, I x0.7",
            Self::Heavy => "m, I x1.3",
            Self::Wide => "m x0.7, I x1.3",
            Self::Narrow => "m x1.3, I x0.7",
            Self::LowBattery => "battery 80 %",
        }
    }

    const fn body(self) -> Option<(f64, f64)> {
        let (low, high) = (1.0 - BODY_SPREAD, 1.0 + BODY_SPREAD);
        match self {
            Self::Light => Some((low, low)),
            Self::Heavy => Some((high, high)),
            Self::Wide => Some((low, high)),
            Self::Narrow => Some((high, low)),
            Self::Drawn | Self::LowBattery => None,
        }
    }
}

/// Late ticks per second at most: of short ticks no more are late. What makes them late, a flash write or a radio, comes at its own rate, twice a second at 100 Hz
/// ([`presets::bad_floor`]), and twice as often where the loop shares the processor with more.
const LATE_HZ: f64 = 4.0;

/// A bad floor for a base.
///
/// [`presets::bad_floor`] has what does not depend on the size of a base: grip, slope, tyres, wheels that
/// are not quite as believed, glitches, supply and current noise, late ticks. Motors, battery, bearings,
/// encoders and pose source are the base's own; drawn on top are mass and inertia (±30 %), where the slope
/// goes down, friction (±30 %), drivers' dead bands (±30 %), the lag of drivers with a speed loop (±30 %), battery (80 to 100 %), the pose source's age (up to half more), of which
/// one pose in twenty is lost, and which side has the larger wheel, the stronger motor and more of the weight: what they do to a base adds up
/// or cancels. The same seed draws the same for every condition but for what it fixes.
pub fn setup(base: &BaseSpec, condition: Condition, seed: u64) -> WorldSetup {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut draw = |(low, high): (f64, f64)| -> f64 {
        let share: f64 = StandardUniform.sample(&mut random);
        low + (high - low) * share
    };
    let spread = (1.0 - BODY_SPREAD, 1.0 + BODY_SPREAD);
    let drawn = (draw(spread), draw(spread));
    let (downhill, friction) = (draw((-3.1, 3.1)), draw(FRICTION));
    let (battery, latency) = (draw(BATTERY), draw(LATENCY));
    let [left_larger, left_stronger, left_heavier] = [(); 3].map(|()| draw((-1.0, 1.0)) < 0.0);
    let lag = draw(LAG);
    let dead_band = draw(DEAD_BAND);
    let bad = presets::bad_floor();
    let mut world = WorldKeys {
        motor: None,
        pose_source: None,
        ..bad.clone()
    };
    (world.body.mass_factor, world.body.inertia_factor) = condition.body().unwrap_or(drawn);
    let body = &mut world.body;
    if left_larger {
        swap(&mut body.radius_right_factor, &mut body.radius_left_factor);
    }
    if left_heavier {
        body.load_right = 1.0 - body.load_right;
    }
    world.floor.downhill_rad = downhill;
    // Off the axle by no more than a tenth of the track, where a small base has little room, and than half of how far out its
    // mass is on average: I > m d², of whatever mass and inertia are drawn, 0.7 I > 1.3 m d².
    let Robot {
        mass_kg,
        inertia_kg_m2,
        wheels,
    } = &base.robot;
    let out_m = (inertia_kg_m2 / mass_kg).sqrt();
    let ahead_m = bad.body.com_ahead_m;
    world.body.com_ahead_m = ahead_m.min(0.1 * wheels.track_m).min(0.5 * out_m);
    if let Some(hardware) = &base.hardware {
        let late = &mut world.tick.late_probability;
        *late = late.min(LATE_HZ * hardware.period_s);
        let own = hardware.world();
        world.motor = own.motor;
        world.speed_loop_s = lag * own.speed_loop_s;
        if let Some(motor) = &mut world.motor {
            motor.dead_band *= dead_band;
            if motor.strength == [1.0, 1.0] {
                // Brushed motors of one lot differ by 5 to 10 %.
                motor.strength = if left_stronger {
                    [0.97, 1.03]
                } else {
                    [1.03, 0.97]
                };
            }
        }
        world.battery = hardware.battery;
        let share = match condition {
            Condition::LowBattery => BATTERY.0,
            _ => battery,
        };
        world.battery.open_circuit_v = Some(share * hardware.battery.nominal_v);
        let rolling = bad.friction.rolling.max(hardware.friction.rolling);
        world.friction = hardware.friction;
        world.friction.static_nm *= friction;
        world.friction.coulomb_nm *= friction;
        world.friction.viscous_nm_s *= friction;
        world.friction.rolling = rolling;
        world.pose_source = hardware.pose_source;
        if let Some(source) = &mut world.pose_source {
            source.latency_s *= latency;
            source.drop_probability = source.drop_probability.max(0.05);
        }
    }
    WorldSetup { world, seed }
}
