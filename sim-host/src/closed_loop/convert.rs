//! Between the plant's doubles and the controller's singles.

use crate::mission::Hardware;
use controller_core::base::{BaseParams, Order, Sensed};
use controller_core::error::ParamError;
use controller_core::gyro::GyroReading;
use controller_core::localiser::{Fix, LocaliserParams};
use controller_core::maths::Single;
use controller_core::motion::Task;
use controller_core::motor::DriverParams;
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::robot::Robot;
use controller_core::safety::{Currents, SupplyDetectorParams};
use controller_core::wheels::WheelGeometry;
use protocol::pil::WheelOutput;

use crate::mission::{BaseSpec, Drivers};
use crate::world::{Actuation, World};

/// Counts per turn and bandwidth of a base that says nothing about its encoders.
const PLAIN_ENCODER: (f64, f64) = (4096.0, 50.0);

/// The core's parameters of a base that ticks every `period_us`: what the simulator runs, and what
/// `sim-host constants` writes for a firmware.
///
/// # Errors
/// The localiser's parameters, on whose noise the others depend.
pub fn params(base: &BaseSpec, period_us: u32) -> Result<BaseParams<f32>, ParamError> {
    let robot: Robot = base.robot.cast();
    let limits = base.limits.cast();
    let (localiser, driver) = match &base.hardware {
        Some(hardware) => (
            hardware.localiser(&base.robot.wheels),
            hardware.driver(base.limits.speed, base.smaller_radius_m()),
        ),
        None => (plain_localiser(robot.wheels), DriverParams::Torques),
    };
    let mut params = BaseParams::new(robot, limits, localiser, driver, period_us)?;
    if let Some(gains) = &base.gains {
        params = params.with_gains(gains.cast());
    }
    if let Some(hardware) = &base.hardware
        && let Drivers::SpeedLoops(_, Some(_)) = hardware.drivers
    {
        // Motors and battery are the drivers' own, but the battery is measured as that of bridges is.
        let volts = hardware.battery.nominal_v as f32;
        params.detectors.supply = SupplyDetectorParams::for_nominal(volts);
    }
    params.policy = base.policy;
    params.supervisor.idle_output = base.idle_output;
    Ok(params)
}

/// What [`params`] assume of a base whose file has no hardware, for people.
pub fn assumed(base: &BaseSpec) -> Option<String> {
    let (counts, _) = PLAIN_ENCODER;
    let period_ms = 1e3 * base.period_s();
    base.hardware.is_none().then(|| {
        format!("states no hardware: encoders of {counts} counts a turn, a tick of {period_ms} ms, no poses and drivers of torques are assumed")
    })
}

fn plain_localiser(wheels: WheelGeometry<f32>) -> LocaliserParams<f32> {
    let (counts, bandwidth) = PLAIN_ENCODER;
    LocaliserParams {
        odometry: OdometryParams {
            wheels,
            calibration: Calibration::NOMINAL,
            counts_per_turn: counts as f32,
            bandwidth: bandwidth as f32,
        },
        fusion: None,
        gyro: None,
    }
}

/// The world of a base: its hardware, but for what the keys say otherwise.
pub(super) fn with_hardware(
    keys: &crate::world::WorldKeys,
    hardware: Option<&Hardware>,
) -> crate::world::WorldKeys {
    let Some(hardware) = hardware else {
        let mut keys = keys.clone();
        keys.encoder.counts_per_turn = PLAIN_ENCODER.0;
        return keys;
    };
    let own = hardware.world();
    let plain = crate::world::WorldKeys::default();
    let mut all = keys.clone();
    all.motor = all.motor.or(own.motor);
    if all.speed_loop_s == plain.speed_loop_s {
        all.speed_loop_s = own.speed_loop_s;
    }
    if all.battery == plain.battery {
        all.battery = own.battery;
    }
    let rolling = all.friction.rolling;
    if (crate::world::FrictionParams {
        rolling: 0.0,
        ..all.friction
    }) == plain.friction
    {
        all.friction = own.friction;
        all.friction.rolling = rolling.max(own.friction.rolling);
    }
    all.encoder.counts_per_turn = own.encoder.counts_per_turn;
    all.pose_source = all.pose_source.or(own.pose_source);
    all.gyro = all.gyro.or(own.gyro);
    all
}

/// What the base measures of a world.
pub(super) fn sensed(world: &World) -> Sensed<f32> {
    let [right, left] = world.currents();
    Sensed {
        counts: world.counts(),
        fix: world.fix().map(|(pose, age_s)| Fix {
            pose: pose.cast(),
            age_s: age_s as f32,
        }),
        gyro: gyro(world),
        supply_v: Some(world.supply_v() as f32),
        currents: Some(Currents {
            right: right as f32,
            left: left as f32,
        }),
        driver: world.drive_answer(),
    }
}

/// What the gyro of a world gave in its last tick.
pub(super) fn gyro(world: &World) -> Option<GyroReading<f32>> {
    world.gyro().map(|sample| GyroReading {
        rate: sample.rate as f32,
        heading: None,
        age_s: sample.age_s as f32,
    })
}

impl From<&WheelOutput> for Actuation {
    fn from(output: &WheelOutput) -> Self {
        match *output {
            WheelOutput::Release => Self::Release,
            WheelOutput::Brake => Self::Brake,
            WheelOutput::Torque { right, left } => Self::Torque {
                right: f64::from(right),
                left: f64::from(left),
            },
            WheelOutput::Duty { right, left } => Self::Duty {
                right: f64::from(right),
                left: f64::from(left),
            },
            WheelOutput::Speed { right, left } => Self::Speed {
                right: f64::from(right),
                left: f64::from(left),
            },
        }
    }
}

/// A task as an order.
pub(crate) fn order(task: &Task<f64>) -> Order<f32> {
    match task {
        Task::Park(goal) => Order::Park(goal.cast()),
        &Task::Drive {
            twist,
            hold_heading,
        } => Order::Drive {
            twist: twist.cast(),
            hold_heading,
        },
        Task::Follow(reference) => Order::Follow(reference.cast_with::<f32, Single>()),
    }
}
