//! Bases that turn their wheels faster than they are told, and bases that are only pushed.

use controller_core::base::{BaseController, BaseParams, BaseReport, Order, Sensed, WheelAction};
use controller_core::hal::WheelCounts;
use controller_core::safety::supervisor::{Cause, Event, State};
use controller_core::safety::{FaultKind, PolicyParams, Response, Timeout};
use controller_core::types::{Pose, Twist, WheelTorques, Wrench};
use controller_core::wheels::WheelMap;
use sim_host::closed_loop;
use sim_host::constants::period_us;
use sim_host::scenario::BASES;
use tests::random::Random;
use tests::stated::{At, Stated};

/// The bases as they are shipped, but that nobody gives them poses.
fn shipped() -> impl Iterator<Item = (&'static str, BaseParams)> {
    BASES.iter().map(|built_in| {
        let file = built_in.base().expect("in order");
        let mut params = closed_loop::params(&file, period_us(&file)).expect("in range");
        params.detectors.pose = Timeout::Off;
        (built_in.name, params)
    })
}

/// What differs from what the base believes.
#[derive(Clone, Copy, Debug)]
struct Truth {
    /// Mass and inertia, as shares of the stated ones.
    heavy: f32,
    /// Torque exerted, and torque that its driver says it exerts, as shares of what is commanded.
    exerted: f32,
    noted: f32,
    /// Force from outside, as a share of what the stated load on both wheels pushes with.
    loads: f32,
}

const AS_STATED: Truth = Truth {
    heavy: 1.0,
    exerted: 1.0,
    noted: 1.0,
    loads: 0.0,
};

/// A rigid base on wheels that roll.
struct Rig {
    params: BaseParams,
    base: BaseController,
    truth: Truth,
    twist: Twist<f32>,
    turned: [f32; 2],
}

impl Rig {
    /// Armed.
    fn new(params: BaseParams, truth: Truth) -> Self {
        let base = params.validate().expect("valid");
        let mut rig = Self {
            params,
            base: BaseController::new(&base, Pose::default()),
            truth,
            twist: Twist::default(),
            turned: [0.0; 2],
        };
        rig.tick(&Order::None);
        rig.base.on(Event::Arm);
        rig
    }

    fn dt(&self) -> f32 {
        1e-6 * self.params.detectors.period_us as f32
    }

    /// Ticks in a time.
    fn ticks(&self, seconds: f32) -> u32 {
        (seconds / self.dt()) as u32
    }

    /// Speed of the faster rim, as a share of the largest.
    fn rim_speed(&self) -> f32 {
        let motion = &self.params.motion;
        let half_track = 0.5 * motion.robot.wheels.track_m;
        (self.twist.linear.abs() + half_track * self.twist.angular.abs()) / motion.limits.rim_speed
    }

    fn tick(&mut self, order: &Order) -> BaseReport {
        let (robot, truth, dt) = (self.params.motion.robot, self.truth, self.dt());
        let per_radian = self.params.localiser.odometry.counts_per_turn / core::f32::consts::TAU;
        let [right, left] = self
            .turned
            .map(|turned| (turned * per_radian).floor() as i32);
        let sensed = Sensed::of_counts(WheelCounts { right, left });
        let report = *self
            .base
            .tick(self.params.detectors.period_us, order, &sensed);
        let torques = report.action.torques().unwrap_or_default();
        let noted = WheelTorques {
            right: truth.noted * torques.right,
            left: truth.noted * torques.left,
        };
        self.base.note_exerted(&noted).expect("not too large");
        let wheels = WheelMap::from_geometry(&robot.wheels).expect("valid");
        let Wrench { force, moment } = wheels.wrench(&torques);
        let load_n = 2.0 * self.params.detectors.wheels.load_nm / robot.wheels.radius_right_m;
        if report.action == WheelAction::Brake {
            self.twist = Twist::default();
        } else {
            let force = truth.exerted * force + truth.loads * load_n;
            self.twist.linear += dt * force / (truth.heavy * robot.mass_kg);
            self.twist.angular += dt * truth.exerted * moment / (truth.heavy * robot.inertia_kg_m2);
        }
        let speeds = wheels.wheel_speeds(&self.twist);
        self.turned[0] += dt * speeds.right;
        self.turned[1] += dt * speeds.left;
        report
    }
}

fn drive(linear: f32, angular: f32) -> Order {
    Order::Drive {
        twist: Twist::new(linear, angular),
        hold_heading: false,
    }
}

/// Motors that exert a quarter to eight times what they are told, drivers that note any torque of either sign, masses and slopes: the longest time for
/// which a rim was faster than 1.6 times the largest speed \[s\], and of how many runs over-speed stopped the base.
fn fast_rims(response: Response) -> (f32, u32) {
    const RUNS: u32 = 400;
    let mut random = Random(20_261_130);
    let (mut longest_s, mut stopped) = (0.0_f32, 0);
    for (_, mut params) in shipped() {
        params.policy.over_speed = response;
        let limits = params.motion.limits;
        for _ in 0..RUNS {
            let mut one = || random.within(1.0) as f32;
            let truth = Truth {
                heavy: 1.0 + 0.3 * one(),
                exerted: (0.5 + 2.5 * one()).exp2(),
                noted: 10.0 * one(),
                loads: 3.0 * one(),
            };
            let order = if one() < 0.0 {
                Order::Park(Pose::new(10.0 * one(), 10.0 * one(), 3.0 * one()))
            } else {
                drive(limits.speed * one(), limits.turn_rate * one())
            };
            let mut rig = Rig::new(params, truth);
            let mut fast_s = 0.0;
            for _ in 0..rig.ticks(20.0) {
                let report = rig.tick(&order);
                fast_s = if rig.rim_speed() > 1.6 {
                    fast_s + rig.dt()
                } else {
                    0.0
                };
                longest_s = longest_s.max(fast_s);
                if let Cause::Fault(fault) = report.cause {
                    stopped += u32::from(fault.kind() == FaultKind::OverSpeed);
                    break;
                }
            }
        }
    }
    (longest_s, stopped)
}

/// Whatever a driver does, and whatever else finds it.
#[test]
fn no_rim_stays_too_fast_whatever_the_driver_does() {
    let mut page = Stated::of("docs/faults.md");
    let (longest_s, stopped) = fast_rims(PolicyParams::DEFAULT.over_speed);
    let (ignored_s, none) = fast_rims(Response::IGNORE);
    println!("{longest_s} s, {stopped}; ignored {ignored_s} s");
    assert_eq!(none, 0);
    page.exactly(
        At::Phrase(
            "Of 1,200 runs with such drivers (`tests/tests/over_speed.rs`) # were stopped by it",
        ),
        &[f64::from(stopped)],
    );
    page.at_most(
        At::Phrase("1.6 times the largest speed for more than # s"),
        &[f64::from(longest_s)],
    );
    page.exactly(
        At::Phrase("with the fault ignored one was for # s"),
        &[f64::from(ignored_s)],
    );
}

/// Loads that no detector takes for a fault are none here either: a base at its largest speed that comes upon a slope of 15 %, as heavy as stated or
/// not, and goes up the same a second later.
#[test]
fn a_slope_is_no_over_speed() {
    for (name, params) in shipped() {
        for heavy in [0.7, 1.0, 1.3] {
            for sign in [1.0, -1.0] {
                let limits = params.motion.limits;
                let mut rig = Rig::new(params, Truth { heavy, ..AS_STATED });
                for tick in 0..rig.ticks(8.0) {
                    let t = tick as f32 * rig.dt();
                    rig.truth.loads = match t {
                        t if t < 5.0 => 0.0,
                        t if t < 6.0 => 3.0 * sign,
                        _ => -3.0 * sign,
                    };
                    let report = rig.tick(&drive(limits.speed, 0.0));
                    assert_eq!(report.state, State::Tracking, "{name}: {:?}", report.cause);
                }
            }
        }
    }
}
