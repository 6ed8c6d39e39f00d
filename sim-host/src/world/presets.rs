//! Worlds that are moderately unkind, with the reason of every number.
//!
//! They are of the size that is met in a room with parts from a shop, not measured on one robot; to
//! match a robot, identify it.

use super::keys::{BodyKeys, WorldKeys};
use super::params::{BatteryParams, FloorParams, FrictionParams, MotorParams};
use super::sense_params::{EncoderParams, NoiseParams, PoseSourceParams, TickParams};

/// A floor, a body, senses and ticks that are all somewhat off. Motors are ideal and bearings
/// free: they belong to a size of base.
pub fn bad_floor() -> WorldKeys {
    WorldKeys {
        body: BodyKeys {
            // A payload of a fifth that the controller does not know of.
            mass_factor: 1.2,
            // Most of it stands near the rim.
            inertia_factor: 1.3,
            // Tread wears and compresses by a per cent, and never the same on both sides.
            radius_right_factor: 1.005,
            radius_left_factor: 0.995,
            // Wide tyres touch the floor somewhere across their width.
            track_factor: 1.02,
            com_ahead_m: 0.01,
            // A caster takes a fifth of the weight.
            load_share: 0.8,
            // Cables and a battery that is not in the middle.
            load_right: 0.52,
            ..BodyKeys::default()
        },
        friction: FrictionParams {
            // Hard rubber on smooth floor: 0.01 to 0.02.
            rolling: 0.015,
            ..FrictionParams::default()
        },
        floor: FloorParams {
            // Rubber on dusty linoleum; clean and dry it is 0.8 to 1.
            mu: 0.5,
            // 1:100, a floor that drains.
            slope_rad: 0.01,
            downhill_rad: 0.8,
            // Solid rubber: full grip at a few per cent of slip, as car tyres have 10 to 30.
            slip_stiffness: 20.0,
            // About the length of the contact of a small wheel.
            relaxation_m: 0.01,
            patch: Vec::new(),
        },
        encoder: EncoderParams {
            // 12 edges per turn of a motor behind 1:34, a common gear motor.
            counts_per_turn: 408.0,
            // One false edge in some 10 s at 100 Hz, from brushes next to the wires.
            glitch_probability: 5.0e-4,
            glitch_counts: 1,
        },
        pose_source: Some(PoseSourceParams {
            // A camera at 30 frames per second that needs two frames to find a marker.
            rate_hz: 30.0,
            latency_s: 0.06,
            // A pixel at 2 m from a wide lens is 5 mm; over a marker of 0.2 m, 0.02 rad.
            noise_m: 0.005,
            noise_rad: 0.02,
            // Motion blur and people in the way.
            drop_probability: 0.05,
            // Calibrated by hand.
            bias_m: [0.003, -0.002],
            bias_rad: 0.002,
        }),
        noise: NoiseParams {
            // Two counts of a 12-bit converter over 20 V.
            supply_v: 0.01,
            // A shunt amplifier beside switching transistors: a per cent of 5 A.
            current_a: 0.05,
        },
        tick: TickParams {
            // An interrupt waits for another one.
            jitter_us: 200,
            // Twice a second at 100 Hz a flash write or a radio comes first, for 2 ms or so.
            late_probability: 0.02,
            late_median_us: 2_000.0,
            // One in twenty of these takes 3 times the median.
            late_spread: 0.7,
        },
        ..WorldKeys::default()
    }
}

/// [`bad_floor`] for 1 kg on toy gear motors of 12 V, as of `bases/hobby-1kg.toml`.
pub fn hobby_1kg() -> WorldKeys {
    with_drive(
        MotorParams {
            // 12 V / (34 · 10.5 mV s) = 34 rad/s free: half more than the 23 rad/s of 0.8 m/s.
            gear_ratio: 34.0,
            kt_nm_per_a: 0.010_5,
            // Spur gears in several stages.
            gear_efficiency: 0.75,
            // 5.6 A stalled.
            resistance_ohm: 2.15,
            // An electrical time constant of 0.6 ms.
            inductance_h: 1.2e-3,
            // A mechanical time constant of 10 ms, as iron rotors have.
            rotor_inertia_kg_m2: 5.0e-7,
            // A small dual driver.
            current_limit_a: 3.0,
            // Dead time and diode drops, 0.4 V of 12.
            dead_band: 0.03,
            // Brushed motors of one lot differ by 5 to 10 %.
            strength: [1.03, 0.97],
        },
        // Eight NiMH cells of 30 mΩ with leads, half empty.
        (12.0, 11.4, 0.35),
        // 0.3 A to turn free and 0.45 A to start, through gear and constant.
        (0.06, 0.04, 5.0e-4),
    )
}

/// [`bad_floor`] for 10 kg on 60 W motors of 24 V, as of `bases/lab-10kg.toml`.
pub fn lab_10kg() -> WorldKeys {
    with_drive(
        MotorParams {
            // 24 V / (26 · 45 mV s) = 20 rad/s free, over the 16 rad/s of 1.2 m/s.
            gear_ratio: 26.0,
            kt_nm_per_a: 0.045,
            // Two planetary stages.
            gear_efficiency: 0.8,
            resistance_ohm: 0.8,
            // 0.5 ms.
            inductance_h: 4.0e-4,
            // 4 ms.
            rotor_inertia_kg_m2: 1.0e-5,
            // Four times the rated 1.5 A of such a motor.
            current_limit_a: 6.0,
            dead_band: 0.02,
            strength: [1.03, 0.97],
        },
        // Two lead batteries in row, half empty.
        (24.0, 23.5, 0.15),
        // 0.2 A to turn free and 0.3 A to start.
        (0.35, 0.23, 4.0e-3),
    )
}

/// [`bad_floor`] for 30 kg on 200 W motors of 48 V, as of `bases/paper-30kg.toml`.
pub fn paper_30kg() -> WorldKeys {
    with_drive(
        MotorParams {
            // 48 V / (30 · 55 mV s) = 29 rad/s free, over the 25 rad/s of 2.5 m/s.
            gear_ratio: 30.0,
            kt_nm_per_a: 0.055,
            gear_efficiency: 0.8,
            resistance_ohm: 0.5,
            // 0.6 ms.
            inductance_h: 3.0e-4,
            // 10 ms.
            rotor_inertia_kg_m2: 6.0e-5,
            // 15.8 N m after the gear, a little over the 15 of the base.
            current_limit_a: 12.0,
            dead_band: 0.02,
            strength: [1.03, 0.97],
        },
        // Thirteen lithium cells in row with fuse and leads, half empty.
        (48.0, 47.0, 0.1),
        // 0.3 A to turn free and 0.45 A to start.
        (0.75, 0.5, 0.01),
    )
}

/// Battery as nominal, open and internal; bearings as static, Coulomb and viscous.
fn with_drive(motor: MotorParams, battery: (f64, f64, f64), bearing: (f64, f64, f64)) -> WorldKeys {
    let mut keys = bad_floor();
    keys.motor = Some(motor);
    keys.battery = BatteryParams {
        nominal_v: battery.0,
        open_circuit_v: Some(battery.1),
        internal_ohm: battery.2,
    };
    (
        keys.friction.static_nm,
        keys.friction.coulomb_nm,
        keys.friction.viscous_nm_s,
    ) = bearing;
    keys
}
