//! Logs of the realistic plant, [`sim_host::world`]: windings, gears, stiction, a battery, poses that
//! come late, drivers with dead bands, tyres. It shares nothing with the model that is fitted.

use crate::robot::{PERIOD, RECORDER, Robot};
use sim_host::identify::Log;
use sim_host::identify::record::{self, SUBSTEP_US};
use sim_host::world::{
    BatteryParams, BodyParams, EncoderParams, FloorParams, FrictionParams, MotorParams,
    NoiseParams, PoseSourceParams, SPEED_LOOP_S, TickParams, WorldParams,
};

/// Gear of the motors that move the robots here.
pub const GEAR: f64 = 20.0;

/// A robot whose sides share what the plant has one number for: resistance and friction.
pub fn same_on_both_sides(robot: &mut Robot) {
    for pair in [
        &mut robot.resistance,
        &mut robot.viscous,
        &mut robot.coulomb,
    ] {
        pair[1] = pair[0];
    }
}

/// The plant of such a robot: all that the fitted model has, windings and stiction beside it.
pub fn plant(robot: &Robot) -> WorldParams {
    let mean = 0.5 * (robot.constant[0] + robot.constant[1]);
    // Iron rotors have most of the inertia; the rest is the wheel's.
    let rotor = 0.7 * robot.wheel_inertia;
    WorldParams {
        body: BodyParams {
            mass_kg: robot.mass,
            inertia_com_kg_m2: robot.inertia,
            com_ahead_m: 0.0,
            radius_right_m: robot.radius[0],
            radius_left_m: robot.radius[1],
            track_m: robot.track,
            wheel_inertia_kg_m2: robot.wheel_inertia - rotor,
            load_share: 1.0,
            load_right: 0.5,
        },
        motor: Some(MotorParams {
            gear_ratio: GEAR,
            gear_efficiency: 1.0,
            kt_nm_per_a: mean / GEAR,
            resistance_ohm: robot.resistance[0],
            // Half a millisecond, as of the motors of bases/.
            inductance_h: 5.0e-4 * robot.resistance[0],
            rotor_inertia_kg_m2: rotor / (GEAR * GEAR),
            current_limit_a: f64::INFINITY,
            dead_band: 0.0,
            strength: robot.constant.map(|k| k / mean),
        }),
        speed_loop_s: SPEED_LOOP_S,
        battery: BatteryParams {
            nominal_v: robot.supply,
            ..BatteryParams::default()
        },
        friction: FrictionParams {
            static_nm: 1.5 * robot.coulomb[0],
            coulomb_nm: robot.coulomb[0],
            viscous_nm_s: robot.viscous[0],
            rolling: 0.0,
        },
        floor: FloorParams::default(),
        push: Vec::new(),
        encoder: EncoderParams {
            counts_per_turn: RECORDER.counts_per_turn,
            ..EncoderParams::default()
        },
        pose_source: Some(PoseSourceParams {
            rate_hz: 20.0,
            // Whole ticks after the moment, so that the age in a row is always the same.
            latency_s: 0.03,
            noise_m: 0.003,
            noise_rad: 0.003,
            drop_probability: 0.0,
            bias_m: [0.0; 2],
            bias_rad: 0.0,
        }),
        gyro: None,
        noise: NoiseParams {
            supply_v: 0.0,
            current_a: 0.05,
        },
        tick: TickParams::default(),
        substep_us: SUBSTEP_US,
    }
}

/// Windings without inductance.
pub fn without_lag(params: &mut WorldParams) {
    if let Some(motor) = &mut params.motor {
        motor.inductance_h = 0.0;
    }
}

/// Records `drive_of(t)`, duties, for `duration_s` as a driver would: duties with the supply measured.
pub fn record(
    params: &WorldParams,
    seed: u64,
    duration_s: f64,
    drive_of: impl Fn(f64) -> [f64; 2],
) -> Log {
    let period_us = (1.0e6 * PERIOD) as u32;
    record::record(params, period_us, seed, duration_s, |_, t| drive_of(t))
        .expect("a world in range")
}
