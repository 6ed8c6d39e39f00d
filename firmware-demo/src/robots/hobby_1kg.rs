// Robot constants: 1 kg hobby base
//
// Made by `sim-host constants` from `hobby-1kg.toml`: change that file, not this one. SI units, radians; what a field is
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
pub const PERIOD_US: u32 = 5_000;

/// All parameters: 1 kg hobby base
pub const BASE: BaseParams<f32> = BaseParams {
    motion: MotionParams {
        robot: Robot {
            mass_kg: 1.9436734,
            inertia_kg_m2: 0.009624,
            wheels: WheelGeometry {
                radius_right_m: 0.035,
                radius_left_m: 0.035,
                track_m: 0.14,
            },
        },
        limits: Limits {
            speed: 0.8,
            turn_rate: 6.0,
            rim_speed: 0.9,
            accel: 1.5,
            brake: 1.5,
            turn_accel: 15.0,
            jerk: 30.0,
            turn_jerk: 300.0,
            wheel_torque_nm: 0.15,
            policy: SaturationPolicy::KeepCurvature,
        },
        gains: MotionGains {
            decay: 20.0,
            longitudinal: 2.25,
            longitudinal_bound: 1.5,
            heading: 7.3,
            lateral: 14.5,
            slow: 0.21858047,
            approach: 1.2,
            approach_brake: 0.9,
            speed_loop: 9.36,
            turn_loop: 12.5,
            disturbance: 4.95,
            disturbance_share: 0.125,
        },
        pose_noise_m: 0.00041717783,
        arrival: Arrival {
            distance_m: 0.0027792635,
            heading_rad: 0.0063139847,
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
                radius_right_m: 0.035,
                radius_left_m: 0.035,
                track_m: 0.14,
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
        gear_ratio: 34.0,
        gear_efficiency: 0.75,
        torque_constant_nm_per_a: 0.0105,
        resistance_ohm: 2.15,
        supply_v: 12.0,
        max_current_a: 3.0,
        friction: WheelFriction {
            coulomb_nm: 0.04,
            stiction_nm: 0.038,
            viscous_nm_s: 0.0005,
            blend_rad_s: 0.022857143,
        },
        dead_band: 0.03,
        rotor_inertia_kg_m2: 5e-7,
    }),
    detectors: DetectorParams {
        period_us: 5_000,
        robot: Robot {
            mass_kg: 1.9436734,
            inertia_kg_m2: 0.009624,
            wheels: WheelGeometry {
                radius_right_m: 0.035,
                radius_left_m: 0.035,
                track_m: 0.14,
            },
        },
        measurement: Timeout::AfterUs(25_000),
        pose: Timeout::AfterUs(1_000_000),
        command: Timeout::AfterUs(100_000),
        ticks: TickDetectorParams {
            late: Timeout::AfterUs(7_500),
            row: 5,
            of_64: 16,
            long: Timeout::AfterUs(50_000),
        },
        wheels: WheelDetectorParams {
            counts_per_turn: 2048.0,
            load_nm: 0.00858375,
            stuck: StuckDetectorParams {
                torque_nm: 0.06575125,
                speed_rad_s: 0.57142854,
                after: Timeout::AfterUs(250_000),
            },
            reversed: Timeout::AfterUs(30_000),
            slip: SlipDetectorParams {
                accel_rad_s2: 85.71429,
                speed_m_s: 0.2,
                after: Timeout::AfterUs(50_000),
            },
        },
        current: CurrentDetectorParams {
            limit_a: 3.3000002,
            after: Timeout::AfterUs(200_000),
        },
        supply: SupplyDetectorParams {
            low_v: 8.4,
            recovered_v: 9.0,
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
