//! Bases that turn their wheels faster than they are told, and bases that are only pushed.

use controller_core::base::Order;
use controller_core::safety::supervisor::{Cause, State};
use controller_core::safety::{FaultKind, PolicyParams, Response};
use controller_core::types::{Pose, Twist};
use tests::random::Random;
use tests::rolling::{AS_STATED, Rig, Truth, shipped};
use tests::stated::{At, Stated};

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
