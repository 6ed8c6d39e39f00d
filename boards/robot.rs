// Robot constants: 1.5 kg bring-up base
//
// Made by `sim-host constants` from `robot.toml`: change that file, not this one. SI units, radians; what a field is
// stands at its type.

use controller_core::base::BaseParams;
use controller_core::localiser::LocaliserParams;
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
pub const PERIOD_US: u32 = 1_000;

/// All parameters: 1.5 kg bring-up base
pub const BASE: BaseParams<f32> = BaseParams {
    motion: MotionParams {
        robot: Robot {
            mass_kg: 2.352071,
            inertia_kg_m2: 0.017453255,
            wheels: WheelGeometry {
                radius_right_m: 0.0325,
                radius_left_m: 0.0325,
                track_m: 0.16,
            },
        },
        limits: Limits {
            speed: 0.8,
            turn_rate: 4.0,
            rim_speed: 0.8,
            accel: 0.8,
            brake: 1.0,
            turn_accel: 8.0,
            jerk: 20.0,
            turn_jerk: 100.0,
            wheel_torque_nm: 0.25,
            policy: SaturationPolicy::KeepCurvature,
        },
        gains: MotionGains {
            decay: 20.0,
            longitudinal: 1.2,
            longitudinal_bound: 1.5,
            heading: 4.0,
            lateral: 5.3654437,
            slow: 0.047905747,
            approach: 1.2,
            approach_brake: 0.6,
            speed_loop: 3.0,
            turn_loop: 5.0,
            disturbance: 2.5,
            disturbance_share: 0.125,
        },
        pose_noise_m: 3.070232e-5,
        arrival: Arrival {
            distance_m: 0.0005,
            heading_rad: 0.001364725,
            dwell_s: 0.05,
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
                radius_right_m: 0.0325,
                radius_left_m: 0.0325,
                track_m: 0.16,
            },
            calibration: Calibration {
                right: 1.0,
                left: 1.0,
                track: 1.0,
            },
            counts_per_turn: 1920.0,
            bandwidth: 60.0,
        },
        fusion: None,
        gyro: None,
    },
    driver: DriverParams::Motors(MotorParams {
        gear_ratio: 30.0,
        gear_efficiency: 1.0,
        torque_constant_nm_per_a: 0.0085,
        resistance_ohm: 2.2,
        supply_v: 12.0,
        max_current_a: 1.0,
        friction: WheelFriction {
            coulomb_nm: 0.0,
            stiction_nm: 0.0,
            viscous_nm_s: 0.0,
            blend_rad_s: 0.024615385,
        },
        dead_band: 0.0,
        rotor_inertia_kg_m2: 5e-7,
    }),
    detectors: DetectorParams {
        period_us: 1_000,
        robot: Robot {
            mass_kg: 2.352071,
            inertia_kg_m2: 0.017453255,
            wheels: WheelGeometry {
                radius_right_m: 0.0325,
                radius_left_m: 0.0325,
                track_m: 0.16,
            },
        },
        measurement: Timeout::AfterUs(5_000),
        pose: Timeout::Off,
        command: Timeout::AfterUs(100_000),
        ticks: TickDetectorParams {
            late: Timeout::AfterUs(1_500),
            row: 5,
            of_64: 16,
            long: Timeout::AfterUs(50_000),
        },
        wheels: WheelDetectorParams {
            counts_per_turn: 1920.0,
            load_nm: 0.011955937,
            stuck: StuckDetectorParams {
                torque_nm: 0.03586781,
                speed_rad_s: 0.61538464,
                after: Timeout::AfterUs(250_000),
            },
            reversed: Timeout::AfterUs(30_000),
            slip: SlipDetectorParams {
                accel_rad_s2: 92.30769,
                speed_m_s: 0.2,
                after: Timeout::AfterUs(50_000),
            },
        },
        current: CurrentDetectorParams {
            limit_a: 1.1,
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
