//! Robot constants: 30 kg base
//!
//! Made by `sim-host constants` from `paper-30kg.toml`: change that file, not this one. SI units, radians.

use controller_core::base::BaseParams;
use controller_core::safety::{Reaction, Response, Timeout};
use controller_core::{localiser, motion, motor, odometry, robot, safety, wheels};

/// Time between ticks \[µs\].
pub const PERIOD_US: u32 = 10_000;

/// All parameters: 30 kg base
pub const BASE: BaseParams<f32> = BaseParams {
    motion: motion::MotionParams {
        robot: robot::Robot {
            // [kg]
            mass_kg: 30.0,
            // About the axle's middle [kg m^2].
            inertia_kg_m2: 15.0,
            wheels: wheels::WheelGeometry {
                // [m]
                radius_right_m: 0.1,
                // [m]
                radius_left_m: 0.1,
                // Between the wheels [m].
                track_m: 0.5,
            },
        },
        limits: motion::Limits {
            // [m/s]
            speed: 2.5,
            // [rad/s]
            turn_rate: 3.0,
            // Away from rest [m/s^2].
            accel: 1.5,
            // Towards rest [m/s^2].
            brake: 1.5,
            // [rad/s^2]
            turn_accel: 0.9,
            // [m/s^3]
            jerk: 20.0,
            // [rad/s^3]
            turn_jerk: 40.0,
            // Of each wheel [N m].
            wheel_torque_nm: 15.0,
            // Who yields at the torque limit.
            policy: motion::SaturationPolicy::KeepCurvature,
        },
        gains: motion::MotionGains {
            // Of pose neurons and transition offsets [1/s].
            decay: 8.0,
            // Along the path [1/s].
            longitudinal: 2.0,
            // Largest speed that it adds [m/s].
            longitudinal_bound: 1.5,
            // [1/s]
            heading: 1.87,
            // Across the path [1/s^2].
            lateral: 1.38,
            // Below this speed the lateral correction fades out [m/s].
            slow: 0.04472136,
            // Towards the goal [1/s].
            approach: 1.58,
            // Planned deceleration [m/s^2].
            approach_brake: 0.9,
            // [1/s]
            speed_loop: 7.0,
            // [1/s]
            turn_loop: 6.3,
            // Bandwidth of the disturbance estimate [1/s].
            disturbance: 3.1,
            // Largest one, over the wheels' largest.
            disturbance_share: 0.125,
        },
        // Of the fused position per tick [m].
        pose_noise_m: 0.00042534707,
        arrival: motion::Arrival {
            // [m]
            distance_m: 0.003513484,
            // [rad]
            heading_rad: 0.006160587,
            // [s]
            dwell_s: 1.0,
            at_rest: motion::AtRest::Hold,
            // [m/s]
            stall_speed: 0.05,
            // [s]
            stall_s: 2.0,
            retries: 2,
        },
        // Jumps are declared, not detected.
        jump: None,
        // Longest accepted tick [s].
        max_tick_s: 0.5,
    },
    localiser: localiser::LocaliserParams {
        odometry: odometry::OdometryParams {
            wheels: wheels::WheelGeometry {
                // [m]
                radius_right_m: 0.1,
                // [m]
                radius_left_m: 0.1,
                // Between the wheels [m].
                track_m: 0.5,
            },
            // Factors on the lengths above.
            calibration: odometry::Calibration {
                right: 1.0,
                left: 1.0,
                track: 1.0,
            },
            // Of a wheel.
            counts_per_turn: 2048.0,
            // Of the speed estimate [rad/s].
            bandwidth: 50.0,
        },
        fusion: Some(localiser::FusionParams {
            // Of a pose [m, standard deviation].
            noise_m: 0.005,
            // [rad, standard deviation]
            noise_rad: 0.005,
            // [Hz]
            rate_hz: 20.0,
            // Of the position's correction [rad/s].
            bandwidth: 0.79999995,
            // [rad/s]
            heading_bandwidth: 0.79999995,
            // Standard deviations.
            gate: 5.0,
            // Outliers that agree.
            relocalise_after: 3,
            // Of the travel of a wheel.
            drift: 0.02,
            // Of a wheel over the floor [m/s].
            slide_m_s: 0.5,
            // [s]
            stale_s: 0.5,
        }),
    },
    motor: Some(motor::MotorParams {
        // Turns of the motor per turn of the wheel.
        gear_ratio: 30.0,
        gear_efficiency: 0.8,
        // [N m/A, V s/rad]
        torque_constant_nm_per_a: 0.055,
        // [ohm]
        resistance_ohm: 0.5,
        // Nominal [V].
        supply_v: 48.0,
        // [A]
        max_current_a: 12.0,
        friction: motor::WheelFriction {
            // At the wheel [N m].
            coulomb_nm: 0.5,
            // To break loose, beyond that [N m].
            stiction_nm: 0.475,
            // [N m s/rad]
            viscous_nm_s: 0.01,
            // [rad/s]
            blend_rad_s: 0.025,
        },
        // Share of the duty.
        dead_band: 0.02,
    }),
    detectors: safety::DetectorParams {
        // [us]
        period_us: 10_000,
        robot: robot::Robot {
            // [kg]
            mass_kg: 30.0,
            // About the axle's middle [kg m^2].
            inertia_kg_m2: 15.0,
            wheels: wheels::WheelGeometry {
                // [m]
                radius_right_m: 0.1,
                // [m]
                radius_left_m: 0.1,
                // Between the wheels [m].
                track_m: 0.5,
            },
        },
        // Encoders without a reading [us].
        measurement: Timeout::AfterUs(50_000),
        // External poses missing [us].
        pose: Timeout::AfterUs(1_000_000),
        // Host or reference silent [us].
        command: Timeout::AfterUs(100_000),
        ticks: safety::TickDetectorParams {
            // [us]
            late: Timeout::AfterUs(15_000),
            row: 5,
            of_64: 16,
            // [us]
            long: Timeout::AfterUs(100_000),
        },
        wheels: safety::WheelDetectorParams {
            // Of a wheel.
            counts_per_turn: 2048.0,
            // From outside, at each wheel [N m].
            load_nm: 0.73575,
            stuck: safety::StuckDetectorParams {
                // [N m]
                torque_nm: 2.70725,
                // [rad/s]
                speed_rad_s: 0.19999999,
                // [us]
                after: Timeout::AfterUs(250_000),
            },
            // [us]
            reversed: Timeout::AfterUs(30_000),
            slip: safety::SlipDetectorParams {
                // [rad/s^2]
                accel_rad_s2: 30.0,
                // [m/s]
                speed_m_s: 0.2,
                // [us]
                after: Timeout::AfterUs(50_000),
            },
        },
        current: safety::CurrentDetectorParams {
            // [A]
            limit_a: 13.200001,
            // [us]
            after: Timeout::AfterUs(200_000),
        },
        supply: safety::SupplyDetectorParams {
            // [V]
            low_v: 33.6,
            // [V]
            recovered_v: 36.0,
            // [us]
            after: Timeout::AfterUs(500_000),
        },
    },
    // What is done about each kind of fault; latched ones need a reset.
    policy: safety::PolicyParams {
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
    },
    supervisor: safety::supervisor::SupervisorParams {
        // [us]
        stop_limit: Timeout::AfterUs(5_000_000),
        // [us]
        brake_limit: Timeout::AfterUs(5_000_000),
        rest: safety::supervisor::RestLimits {
            // [m/s]
            speed_m_s: 0.01,
            // [rad/s]
            turn_rad_s: 0.02,
            // [us]
            dwell_us: 100_000,
        },
        emergency: safety::supervisor::Emergency::Brake,
        parked: motion::AtRest::Hold,
        idle_output: safety::supervisor::IdleOutput::Release,
    },
};
