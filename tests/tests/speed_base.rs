//! A whole base whose drivers close their own speed loop.

use controller_core::base::{
    BaseController, BaseError, BaseParams, BaseReport, Order, Sensed, WheelAction,
};
use controller_core::error::{Field, ParamError, Problem};
use controller_core::hal::WheelCounts;
use controller_core::localiser::LocaliserParams;
use controller_core::motion::{Limits, Outcome, SaturationPolicy};
use controller_core::motor::{DriverParams, SpeedParams};
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::reference::Reference;
use controller_core::robot::Robot;
use controller_core::safety::supervisor::{Event, State, Then};
use controller_core::safety::{Fault, Side, Timeout};
use controller_core::types::{Accel, Pose, Twist, WheelSpeeds, WheelTorques};

const TICK_US: u32 = 10_000;
const DT: f32 = 0.01;
const SPEEDS: SpeedParams = SpeedParams {
    max_speed_rad_s: 14.0,
    min_speed_rad_s: 0.0,
    lag_s: 0.03,
    breakaway_nm: 0.0,
};
const COUNTS: f32 = 4096.0;

fn params(speeds: SpeedParams) -> BaseParams {
    let robot = Robot::<f32>::paper();
    let limits = Limits {
        speed: 1.0,
        turn_rate: 2.0,
        rim_speed: 1.2,
        accel: 0.8,
        brake: 1.0,
        turn_accel: 2.0,
        jerk: 20.0,
        turn_jerk: 40.0,
        wheel_torque_nm: 8.0,
        policy: SaturationPolicy::KeepCurvature,
    };
    let localiser = LocaliserParams {
        odometry: OdometryParams {
            wheels: robot.wheels,
            calibration: Calibration::NOMINAL,
            counts_per_turn: COUNTS,
            bandwidth: 50.0,
        },
        fusion: None,
        gyro: None,
    };
    BaseParams::new(
        robot,
        limits,
        localiser,
        DriverParams::Speeds(speeds),
        TICK_US,
    )
    .expect("valid")
}

/// Drivers that follow as a first-order lag, on encoders: what the base does with them.
struct Rig {
    base: BaseController,
    lag_s: f32,
    /// Speed that a driver turns its wheel at, over what it is told.
    faster: f32,
    speeds: [f32; 2],
    turned: [f32; 2],
    /// A wheel that does not turn, and one whose counts have the wrong sign.
    blocked: [bool; 2],
    sign: [f32; 2],
}

impl Rig {
    fn new(speeds: SpeedParams) -> Self {
        let base = params(speeds).validate().expect("valid");
        let mut rig = Self {
            base: BaseController::new(&base, Pose::default()),
            lag_s: speeds.lag_s,
            faster: 1.0,
            speeds: [0.0; 2],
            turned: [0.0; 2],
            blocked: [false; 2],
            sign: [1.0; 2],
        };
        rig.tick(&Order::None);
        rig.base.on(Event::Arm);
        rig
    }

    fn tick(&mut self, order: &Order) -> BaseReport {
        let [right, left] = [0, 1].map(|i| {
            (self.sign[i] * self.turned[i] * COUNTS / core::f32::consts::TAU).floor() as i32
        });
        let sensed = Sensed::of_counts(WheelCounts { right, left });
        let report = *self.base.tick(TICK_US, order, &sensed);
        let asked = match &report.action {
            WheelAction::Drive(drive) => [drive.desired.right, drive.desired.left],
            WheelAction::Release | WheelAction::Brake => [0.0; 2],
        };
        for (i, asked) in asked.into_iter().enumerate() {
            let share = 1.0 - (-DT / self.lag_s).exp();
            self.speeds[i] += share * (self.faster * asked - self.speeds[i]);
            if self.blocked[i] {
                self.speeds[i] = 0.0;
            }
            self.turned[i] += DT * self.speeds[i];
        }
        report
    }

    /// Ticks until `fault` is found.
    fn until(&mut self, order: &Order, fault: Fault) -> u32 {
        for tick in 1..1000 {
            let report = self.tick(order);
            if report.active_faults.iter().any(|found| found == fault) {
                return tick;
            }
        }
        panic!("{fault:?} is not found");
    }
}

fn drive(speed: f32) -> Order {
    Order::Drive {
        twist: Twist::new(speed, 0.0),
        hold_heading: false,
    }
}

/// It parks to the last count, and says what it commands: speeds led by the lag, and the torque that the body takes for its acceleration. Of the drivers' torque
/// nothing is believed: no disturbance is learnt of it.
#[test]
fn it_parks_by_speeds() {
    let mut rig = Rig::new(SPEEDS);
    let goal = Order::Park(Pose::new(1.0, 0.3, 0.5));
    let base = *rig.base.base();
    let (wheels, robot) = (*base.motion().wheels(), base.motion().params().robot);
    for tick in 0..1000 {
        let report = rig.tick(&goal);
        let motion = report.motion.expect("at work");
        let WheelAction::Drive(drive) = report.action else {
            panic!("tick {tick}: {report:?}");
        };
        let (command, rate) = (motion.command, motion.command_rate);
        let led = wheels.wheel_speeds(&Twist::new(
            command.linear + SPEEDS.lag_s * rate.linear,
            command.angular + SPEEDS.lag_s * rate.angular,
        ));
        let WheelSpeeds { right, left } = drive.desired;
        // Beside the goal up to the speed from which on a wheel is watched on top of it.
        let most = base.detectors().params().wheels.stuck.speed_rad_s + 1e-5;
        let off = (right - led.right).abs().max((left - led.left).abs());
        assert!(off <= most, "tick {tick}: {off}");
        let wrench = wheels.wrench(&drive.torques);
        assert!((wrench.force - robot.mass_kg * rate.linear).abs() < 1e-4);
        assert!((wrench.moment - robot.inertia_kg_m2 * rate.angular).abs() < 1e-4);
        assert_eq!(
            (motion.disturbance.force, motion.disturbance.moment),
            (0.0, 0.0)
        );
        if motion.outcome == Outcome::Parked {
            let pose = report.measured.expect("measured").pose;
            let off = ((pose.x - 1.0).powi(2) + (pose.y - 0.3).powi(2)).sqrt();
            // A count is 0.15 mm; the tolerance of a base without poses is exact.
            assert!(off < 1e-3 && (pose.theta - 0.5).abs() < 2e-3, "{pose:?}");
            return;
        }
    }
    panic!("not parked within 10 s");
}

/// Speed 0 would stop a base that rolls with all that its drivers have: without a law at work the wheels are let go.
#[test]
fn without_a_law_at_work_the_wheels_are_free() {
    let mut rig = Rig::new(SPEEDS);
    let report = rig.tick(&Order::None);
    assert_eq!(
        (report.state, report.action),
        (State::Armed, WheelAction::Release)
    );
    for _ in 0..100 {
        rig.tick(&drive(0.5));
    }
    assert!(matches!(rig.base.report().action, WheelAction::Drive(_)));
    assert_eq!(rig.base.emergency_stop(), WheelAction::Brake);
    assert_eq!(rig.tick(&drive(0.5)).action, WheelAction::Brake);
}

/// A driver that takes rad/s for turns per second: a base that is told to go at half of its speed goes three times as fast as it ever should.
#[test]
fn a_driver_that_takes_radians_for_turns_is_over_speed() {
    let mut rig = Rig::new(SPEEDS);
    rig.faster = core::f32::consts::TAU;
    let ticks = rig.until(&drive(0.5), Fault::OverSpeed(Side::Both));
    assert_eq!(rig.base.report().action, WheelAction::Brake);
    assert_eq!(rig.base.report().state, State::Braking(Then::Fault));
    // Up to the limit of 1.5 m/s within 0.4 s, by accelerations of 0.8 m/s² as they are told; and a tenth of a second.
    assert!(ticks < 60, "{ticks}");
}

/// What a driver says of torques is taken for the next tick's speed and for nothing else.
#[test]
fn what_was_exerted_teaches_no_disturbance() {
    let mut rig = Rig::new(SPEEDS);
    for _ in 0..200 {
        rig.tick(&drive(0.4));
        let torques = WheelTorques {
            right: -5.0,
            left: 5.0,
        };
        rig.base.note_exerted(&torques).expect("finite");
    }
    let motion = rig.base.report().motion.expect("at work");
    assert_eq!(
        (motion.disturbance.force, motion.disturbance.moment),
        (0.0, 0.0)
    );
}

/// The rim speed of the limits is reached by these drivers; with the lead it is more, which is limited on the same curve, and said.
#[test]
fn what_the_drivers_do_not_reach_is_said() {
    let slow = SpeedParams {
        max_speed_rad_s: 12.0,
        ..SPEEDS
    };
    let mut rig = Rig::new(slow);
    let mut limited = 0;
    for _ in 0..300 {
        let report = rig.tick(&drive(1.2));
        let WheelAction::Drive(drive) = report.action else {
            panic!("{report:?}");
        };
        assert!(drive.desired.right.abs() <= 12.0 && drive.desired.left.abs() <= 12.0);
        limited += u32::from(report.speed_limited.speed);
        assert!(!report.speed_limited.slow);
    }
    // At the top speed of 1 m/s, 10 rad/s, nothing is limited; a slowest speed is.
    assert_eq!(limited, 0);
    let mut rig = Rig::new(SpeedParams {
        min_speed_rad_s: 1.0,
        ..SPEEDS
    });
    let slow = (0..300).filter(|_| rig.tick(&drive(0.02)).speed_limited.slow);
    assert!(slow.count() > 100);
    // 2 cm/s are a fifth of the slowest speed: in pulses, and right in the mean.
    let gone = |rig: &Rig| 0.1 * 0.5 * (rig.turned[0] + rig.turned[1]);
    let before = gone(&rig);
    for _ in 0..1000 {
        rig.tick(&drive(0.02));
    }
    let way = gone(&rig) - before;
    // A wheel starts at 3/4 of the slowest speed, once it lacks (0.75 - 0.2)/k rad, k = 1/(4 · 0.04 s): 9 mm.
    assert!((way - 0.2).abs() < 0.009, "{way}");
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let above = |field, most| {
        BaseError::Param(ParamError {
            field,
            problem: Problem::Above(most),
        })
    };
    let weak = SpeedParams {
        max_speed_rad_s: 8.0,
        ..SPEEDS
    };
    // 8 rad/s on 0.1 m, in single precision.
    let most = f64::from(8.0_f32 * 0.1_f32);
    assert_eq!(
        params(weak).validate(),
        Err(above(Field::MaxRimSpeed, most))
    );
    let late = params(SpeedParams {
        lag_s: 2.0,
        ..SPEEDS
    });
    assert_eq!(late.validate(), Err(above(Field::DriverLag, 1.0)));
    let mut by_torque = params(SPEEDS);
    by_torque.detectors.wheels.stuck.torque_nm = 1.0;
    assert_eq!(by_torque.validate(), Err(above(Field::StuckTorque, 0.0)));
    let mut by_nothing = params(SPEEDS);
    by_nothing.driver = DriverParams::Torques;
    let error = by_nothing
        .validate()
        .expect_err("a torque of 0 pushes nothing");
    assert!(
        matches!(
            error,
            BaseError::Param(ParamError {
                field: Field::StuckTorque,
                ..
            })
        ),
        "{error}"
    );
    let nan = params(SpeedParams {
        lag_s: f32::NAN,
        ..SPEEDS
    });
    assert!(nan.validate().is_err());
}

/// A wheel that does not turn is found in the time that stands in the parameters, and where it is commanded more slowly after the same way.
#[test]
fn a_wheel_that_does_not_turn_is_found() {
    for (side, blocked) in [(Side::Right, [true, false]), (Side::Left, [false, true])] {
        // 20 mm of way from 8 cm/s down, LOOK_US and three ticks, and the time to get there at 0.8 m/s²; the turn that the other wheel makes of the base is
        // commanded back, so this one is to turn by up to a quarter faster.
        for (speed, least, most) in [(0.5, 25, 50), (0.04, 40, 62), (0.025, 64, 95)] {
            let mut rig = Rig::new(SPEEDS);
            rig.blocked = blocked;
            let ticks = rig.until(&drive(speed), Fault::EncoderStuck(side));
            assert!((least..=most).contains(&ticks), "{side:?} {speed}: {ticks}");
        }
    }
    let rig = Rig::new(SPEEDS);
    assert_eq!(
        rig.base.base().detectors().params().wheels.stuck.after,
        Timeout::AfterUs(250_000)
    );
    // To overcome friction c from as much pushed the other way, twice 4 T² c g: 8 · 0.01 · 0.2 · 9.81 m at 8 cm/s, 1.96 s.
    let soft = params(SpeedParams {
        lag_s: 0.1,
        ..SPEEDS
    });
    assert_eq!(
        soft.detectors.wheels.stuck.after,
        Timeout::AfterUs(1_962_000)
    );
    // What more holds a wheel is overcome later: 8 T² · 2 τ/(m r), by 9 N m on 30 kg and wheels of 0.1 m 8 · 0.01 · 6 m at 8 cm/s.
    let held = params(SpeedParams {
        lag_s: 0.1,
        breakaway_nm: 9.0,
        ..SPEEDS
    });
    assert_eq!(
        held.detectors.wheels.stuck.after,
        Timeout::AfterUs(6_000_000)
    );
}

/// What is slower than a driver executes turns no wheel, and that is no fault; what is faster is one, if nothing turns.
#[test]
fn a_wheel_that_is_to_turn_more_slowly_than_its_driver_can_is_not_stuck() {
    let slow = SpeedParams {
        min_speed_rad_s: 1.0,
        ..SPEEDS
    };
    let radius = Robot::<f32>::paper().wheels.radius_right_m;
    // A reference that moves without going away: the command stays what it says.
    let beside = |speed: f32| {
        let twist = Twist::new(speed * radius, 0.0);
        Order::Follow(Reference::new(Pose::default(), twist, Accel::default()))
    };
    let mut rig = Rig::new(slow);
    // Three times what finds a wheel whose driver has no slowest speed; a base that does not go on at all is stalled after two seconds.
    for _ in 0..100 {
        let report = rig.tick(&beside(0.7));
        assert!(
            report.active_faults.is_empty(),
            "{:?}",
            report.active_faults
        );
        assert!(!matches!(&report.action, WheelAction::Drive(drive) if drive.desired.right != 0.0));
    }
    let command = rig.base.report().motion.expect("it follows").command;
    assert!(command.linear > 0.6 * radius, "{command:?}");
    // At the slowest speed it is found after four times the time: that is the way of SLOW.
    for (speed, most) in [(1.1, 140), (4.4, 70)] {
        let mut rig = Rig::new(slow);
        rig.blocked = [true, false];
        let ticks = rig.until(&beside(speed), Fault::EncoderStuck(Side::Right));
        assert!(ticks <= most, "{speed}: {ticks}");
    }
}

#[test]
fn a_wheel_that_counts_backward_is_found() {
    let mut rig = Rig::new(SPEEDS);
    rig.sign[1] = -1.0;
    let ticks = rig.until(&drive(0.5), Fault::EncoderReversed(Side::Left));
    assert!(ticks <= 60, "{ticks}");
}
