// Robot constants: 10 kg lab base
//
// Made by `sim-host constants` from `lab-10kg.toml`: change that file, not this one. SI units, radians; what a field is
// stands at its type.

use controller_core::base::BaseParams;
use controller_core::localiser::{FusionParams, LocaliserParams};
use controller_core::motion::{
    Arrival, AtRest, Limits, MotionGains, MotionParams, Parking, SaturationPolicy,
};
use controller_core::motor::{DriverParams, MotorParams, WheelFriction};
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::robot::Robot;
use controller_core::safety::supervisor::{Emergency, IdleOutput, RestLimits, SupervisorParams};
use controller_core::safety::{
    CurrentDetectorParams, DetectorParams, PolicyParams, Reaction, Response, SlipDetectorParams,
    StuckDetectorParams, SupplyDetectorParams, TickDetectorParams, Timeout, WheelDetectorParams,
};
use controller_core::wheels::WheelGeometry;

/// Time between ticks \[µs\].
pub const PERIOD_US: u32 = 10_000;

/// All parameters: 10 kg lab base
pub const BASE: BaseParams<f32> = BaseParams {
    motion: MotionParams {
        robot: Robot {
            mass_kg: 12.403555,
            inertia_kg_m2: 0.3736089,
            wheels: WheelGeometry {
                radius_right_m: 0.075,
                radius_left_m: 0.075,
                track_m: 0.35,
            },
        },
        limits: Limits {
            speed: 1.2,
            turn_rate: 3.0,
            rim_speed: 1.2,
            accel: 1.0,
            brake: 1.5,
            turn_accel: 6.0,
            jerk: 20.0,
            turn_jerk: 80.0,
            wheel_torque_nm: 2.0,
            policy: SaturationPolicy::KeepCurvature,
        },
        gains: MotionGains {
            decay: 20.0,
            longitudinal: 2.55,
            longitudinal_bound: 1.5,
            heading: 5.2,
            lateral: 8.8,
            slow: 0.1909204,
            approach: 1.55,
            approach_brake: 0.9,
            speed_loop: 7.0,
            turn_loop: 8.2,
            disturbance: 3.1,
            disturbance_share: 0.125,
        },
        pose_noise_m: 0.0004212939,
        arrival: Arrival {
            distance_m: 0.002799844,
            heading_rad: 0.006204415,
            dwell_s: 1.2500001,
            parking: Parking::Planned,
            at_rest: AtRest::Hold,
            stall_speed: 0.05,
            stall_s: 2.0,
            retries: 2,
        },
        jump: None,
        max_tick_s: 0.5,
    },
    localiser: LocaliserParams {
        odometry: OdometryParams {
            wheels: WheelGeometry {
                radius_right_m: 0.075,
                radius_left_m: 0.075,
                track_m: 0.35,
            },
            calibration: Calibration {
                right: 1.0,
                left: 1.0,
                track: 1.0,
            },
            counts_per_turn: 2048.0,
            bandwidth: 50.0,
        },
        fusion: Some(FusionParams {
            noise_m: 0.005,
            noise_rad: 0.005,
            rate_hz: 20.0,
            bandwidth: 0.79999995,
            heading_bandwidth: 0.79999995,
            gate: 5.0,
            relocalise_after: 3,
            drift: 0.02,
            slide_m_s: 0.5,
            stale_s: 0.5,
        }),
        gyro: None,
    },
    driver: DriverParams::Motors(MotorParams {
        gear_ratio: 26.0,
        gear_efficiency: 0.8,
        torque_constant_nm_per_a: 0.045,
        resistance_ohm: 0.8,
        supply_v: 24.0,
        max_current_a: 6.0,
        friction: WheelFriction {
            coulomb_nm: 0.23,
            stiction_nm: 0.225,
            viscous_nm_s: 0.004,
            blend_rad_s: 0.016,
        },
        dead_band: 0.02,
        rotor_inertia_kg_m2: 1e-5,
    }),
    detectors: DetectorParams {
        period_us: 10_000,
        robot: Robot {
            mass_kg: 12.403555,
            inertia_kg_m2: 0.3736089,
            wheels: WheelGeometry {
                radius_right_m: 0.075,
                radius_left_m: 0.075,
                track_m: 0.35,
            },
        },
        measurement: Timeout::AfterUs(50_000),
        pose: Timeout::AfterUs(1_000_000),
        command: Timeout::AfterUs(100_000),
        ticks: TickDetectorParams {
            late: Timeout::AfterUs(15_000),
            row: 5,
            of_64: 16,
            long: Timeout::AfterUs(100_000),
        },
        wheels: WheelDetectorParams {
            counts_per_turn: 2048.0,
            load_nm: 0.18393752,
            stuck: StuckDetectorParams {
                torque_nm: 0.78181255,
                speed_rad_s: 0.26666665,
                after: Timeout::AfterUs(250_000),
            },
            reversed: Timeout::AfterUs(30_000),
            slip: SlipDetectorParams {
                accel_rad_s2: 40.0,
                speed_m_s: 0.2,
                after: Timeout::AfterUs(50_000),
            },
        },
        current: CurrentDetectorParams {
            limit_a: 6.6000004,
            after: Timeout::AfterUs(200_000),
        },
        supply: SupplyDetectorParams {
            low_v: 16.8,
            recovered_v: 18.0,
            after: Timeout::AfterUs(500_000),
        },
    },
    policy: PolicyParams {
        measurement_stale: Response::latched(Reaction::Brake),
        pose_stale: Response::passing(Reaction::ControlledStop),
        command_stale: Response::passing(Reaction::ControlledStop),
        not_finite: Response::latched(Reaction::Brake),
        tick_jitter: Response::latched(Reaction::ControlledStop),
        tick_too_long: Response::latched(Reaction::ControlledStop),
        pose_jump: Response::passing(Reaction::Ignore),
        encoder_stuck: Response::latched(Reaction::Brake),
        encoder_reversed: Response::latched(Reaction::Brake),
        wheel_slip: Response::passing(Reaction::ControlledStop),
        driver: Response::latched(Reaction::Release),
        over_current: Response::latched(Reaction::Release),
        under_voltage: Response::latched(Reaction::ControlledStop),
        step_refused: Response::latched(Reaction::Brake),
        stalled: Response::passing(Reaction::ControlledStop),
        goal_unreachable: Response::passing(Reaction::ControlledStop),
        gyro: Response::passing(Reaction::Ignore),
        over_speed: Response::latched(Reaction::Brake),
    },
    supervisor: SupervisorParams {
        stop_limit: Timeout::AfterUs(5_000_000),
        brake_limit: Timeout::AfterUs(5_000_000),
        rest: RestLimits {
            speed_m_s: 0.01,
            turn_rad_s: 0.02,
            dwell_us: 100_000,
        },
        emergency: Emergency::Brake,
        parked: AtRest::Hold,
        idle_output: IdleOutput::Release,
    },
};
