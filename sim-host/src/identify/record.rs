//! Logs of a base as its file has it, from the realistic plant [`world`](crate::world): the drive that
//! `docs/identify.md` recommends, and what a driver measures on it. The plant shares nothing with the model that is
//! fitted.

use super::log::{Drive, Fix, Log, voltages};
use crate::mission::{BaseSpec, Hardware};
use crate::world::{Actuation, MotorParams, World, WorldError, WorldKeys, WorldParams};
use controller_core::types::{Measured, Pose, Twist};
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;

/// Length of the drive \[s\].
pub const DURATION_S: f64 = 25.0;
/// Noise of a current, as a share of the driver's limit: the full scale of what senses it, ±1 % of shunt and amplifier.
pub const CURRENT_NOISE: f64 = 0.01;
/// Noise of the supply, as a share of it: a step of a converter of ten bits.
pub const SUPPLY_NOISE: f64 = 0.001;
/// Integration step \[us\]: half the plant's own, of which an identification sees more than a drive does. It shifts no quantity by
/// more than 0.02 %, which no log shows; the plant's own shifts mass, inertia and dry friction by 0.04 %.
pub const SUBSTEP_US: u32 = 250;
/// Share of the base's wheel torque that its ramps ask for. The rest is for friction and gear losses, and a drive that
/// comes near to the driver's current limit shows less than one that does not.
const RAMP_SHARE: f64 = 0.5;

/// Records `duty_of(row, t)` for `duration_s` as a driver would: what it measures, at ticks of `period_us`.
///
/// # Errors
/// Parameters out of range.
pub fn record(
    params: &WorldParams,
    period_us: u32,
    seed: u64,
    duration_s: f64,
    mut duty_of: impl FnMut(usize, f64) -> [f64; 2],
) -> Result<Log, WorldError> {
    let start = Measured {
        pose: Pose::new(0.3, -0.2, 1.0),
        twist: Twist::new(0.0, 0.0),
    };
    let mut world = World::new(params, &start, seed)?;
    let step = TAU / params.encoder.counts_per_turn;
    let (mut t, mut angle, mut current, mut fixes) = (vec![], vec![], vec![], vec![]);
    let (mut duty, mut supply) = (vec![], vec![]);
    loop {
        let now = 1.0e-6 * world.now_us() as f64;
        if now >= duration_s {
            break;
        }
        // No defect is put in, so there are counts.
        let counts = world.counts().unwrap_or_default();
        if let Some((pose, _)) = world.fix() {
            fixes.push(Fix {
                row: t.len(),
                pose: [pose.x, pose.y, pose.theta],
                age_s: 0.0,
            });
        }
        let [right, left] = duty_of(t.len(), now).map(|duty| duty.clamp(-1.0, 1.0));
        t.push(now);
        angle.push([counts.right, counts.left].map(|count| f64::from(count) * step));
        current.push(world.currents());
        supply.push(world.supply_v());
        duty.push([right, left]);
        let dt_us = world.next_tick_us(period_us);
        // A duty within -1 to 1, and ticks of milliseconds.
        if world
            .advance(&Actuation::Duty { right, left }, dt_us)
            .is_err()
        {
            break;
        }
    }
    let (command, under) = voltages(&duty, &supply);
    Ok(Log {
        t,
        drive: Drive::Voltage,
        command,
        supply: Some(under),
        angle,
        step_rad: Some(step),
        current: Some(current),
        fixes,
    })
}

/// The world of this hardware, with noise on what its drivers measure.
pub fn sensed_world(hardware: &Hardware) -> WorldKeys {
    let mut keys = hardware.world();
    keys.substep_us = SUBSTEP_US;
    keys.noise.supply_v = SUPPLY_NOISE * hardware.battery.nominal_v;
    if let Some(motor) = hardware.drivers.motor()
        && motor.current_limit_a.is_finite()
    {
        keys.noise.current_a = CURRENT_NOISE * motor.current_limit_a;
    }
    keys
}

/// A drive of the base with all of its own hardware, whose motors take duties, as it is recommended: another one for each seed.
///
/// # Errors
/// Hardware that is no plant.
pub fn base_log(
    base: &BaseSpec,
    (hardware, motor): (&Hardware, &MotorParams),
    seed: u64,
) -> Result<Log, WorldError> {
    let params = sensed_world(hardware).params(&base.robot);
    let period_us = (1.0e6 * hardware.period_s).round() as u32;
    let duties = drive(base, (hardware, motor), seed);
    record(&params, period_us, seed, DURATION_S, |row, _| {
        duties.get(row).copied().unwrap_or_default()
    })
}

/// A part of the drive: until when \[s\], the direction of each wheel, and whether both get the same duty.
type Part = (f64, [f64; 2], bool);

/// Straight on, turning on the spot, backward in arcs, forward with each side on its own.
const PARTS: [Part; 4] = [
    (6.0, [1.0, 1.0], true),
    (12.0, [1.0, -1.0], true),
    (18.0, [-1.0, -1.0], false),
    (DURATION_S, [1.0, 1.0], false),
];
/// Pause between parts \[s\].
const PAUSE_S: f64 = 0.5;

/// Duties row by row: levels of 30 to 80 % for 0.3 to 1 s, drawn by `seed`, joined by ramps.
fn drive(
    base: &BaseSpec,
    (hardware, motor): (&Hardware, &MotorParams),
    seed: u64,
) -> Vec<[f64; 2]> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let robot = base.robot_with_rotors();
    let r2 = robot.wheels.radius_right_m * robot.wheels.radius_left_m;
    let straight = 0.5 * robot.mass_kg * r2;
    let turning = 2.0 * robot.inertia_kg_m2 * r2 / robot.wheels.track_m.powi(2);
    // Duty per second that accelerates a wheel of this inertia with the torque for ramps.
    let constant = motor.gear_ratio * motor.kt_nm_per_a;
    let torque = RAMP_SHARE * base.limits.wheel_torque_nm;
    let slope = |inertia: f64| torque / inertia * constant / hardware.battery.nominal_v;
    let (mut duty, mut level, mut until) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    let (mut part, mut from) = (0, 0.0);
    let mut duties = Vec::new();
    for row in 0.. {
        let t = row as f64 * hardware.period_s;
        if t >= DURATION_S {
            break;
        }
        if t >= PARTS[part].0 {
            from = PARTS[part].0 + PAUSE_S;
            part += 1;
            (level, until) = ([0.0; 2], [from; 2]);
        }
        let (_, direction, both) = PARTS[part];
        let inertia = if part == 0 {
            straight
        } else {
            straight.max(turning)
        };
        let most = slope(inertia) * hardware.period_s;
        for i in 0..2 {
            if t >= until[i] && t >= from {
                level[i] = random.random_range(0.3..0.8);
                until[i] = t + random.random_range(0.3..1.0);
                if both {
                    (level, until) = ([level[i]; 2], [until[i]; 2]);
                }
            }
        }
        for i in 0..2 {
            let to: f64 = direction[i] * level[i];
            duty[i] += (to - duty[i]).clamp(-most, most);
        }
        duties.push(duty);
    }
    duties
}
