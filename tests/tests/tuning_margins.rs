//! Margins agree with the loop itself: just below them it settles, just above it grows.

use controller_core::maths::Libm;
use controller_core::motion::{MotionGains, MotionParams, Parking, Task};
use controller_core::tuning::motion::margins;
use controller_core::types::{Pose, Twist};
use tests::motion_base::Body;
use tests::motion_loop::{Order, steady};
use tests::tuning_loop::{AS_BELIEVED, BASES, Instant, Truth, base, drive, peak, shipped};

/// Distance from a delay margin at which the loop's side is clear: held torque adds half a tick of 1 ms, a late pose
/// is a whole number of ticks, and both are at most 1 % of the margins tried.
const NEAR: f64 = 0.04;
/// Beyond the margin for torques that are late the load estimate still holds the loop for a while: it finds the robot heavier or
/// lighter, as it suits. From here on it does not.
const LENT: f64 = 2.0;

/// Speed of the tests \[m/s\]: within that of every base.
const SPEED: f64 = 0.5;

/// The error's size grows from the start of a run to its end.
///
/// Across the path at speed, along it at rest. The start is 0.1 mm beside where late poses let the robot rest, which is
/// ahead by speed times delay: neurons and limits are linear there.
fn grows(params: &MotionParams<f64>, truth: Truth, across: bool) -> bool {
    let (end, off) = (60.0, 1e-4);
    let speed = if across { SPEED } else { 0.0 };
    let mut body = if across {
        Body::at(speed * truth.pose_late as f64 * truth.dt, off, 0.0)
    } else {
        Body::at(-off, 0.0, 0.0)
    };
    body.twist = Twist::new(speed, 0.0);
    let run = drive(params, truth, body, steady(speed, 0.0), end);
    let part = |now: &Instant| {
        if across { now.error.1 } else { now.error.0 }
    };
    let (early, late) = (peak(&run, 10.0, 20.0, part), peak(&run, 50.0, end, part));
    // A limit cycle of large size is grown, however steady by now.
    late > early || late > 0.01
}

/// A margin in ticks of 1 ms, `share` of it.
fn ticks(margin_s: f64, share: f64) -> usize {
    (share * margin_s / 1e-3).round() as usize
}

/// Both sides of both delay margins, along and across, for the shipped gains of every base and those that follow from
/// its limits.
#[test]
fn delay_margins_are_where_the_loop_starts_to_grow() {
    for (name, params) in BASES
        .into_iter()
        .flat_map(|name| [(name, base(name)), (name, shipped(name))])
    {
        let found = margins::<f64, Libm>(&params.gains);
        for (across, of) in [(false, found.longitudinal), (true, found.lateral)] {
            println!(
                "{name}, across {across}: pose {:.3} s, torque {:.3} s",
                of.pose_delay_s, of.torque_delay_s
            );
            let late = |share: f64| Truth {
                pose_late: ticks(of.pose_delay_s, share),
                dt: 1e-3,
                ..AS_BELIEVED
            };
            let slow = |share: f64| Truth {
                torque_late: ticks(of.torque_delay_s - 0.5e-3, share),
                dt: 1e-3,
                ..AS_BELIEVED
            };
            for truth in [late(1.0 - NEAR), slow(1.0 - NEAR)] {
                assert!(!grows(&params, truth, across), "{name}: {truth:?} grows");
            }
            for truth in [late(1.0 + NEAR), slow(LENT)] {
                assert!(grows(&params, truth, across), "{name}: {truth:?} settles");
            }
        }
    }
}

/// Heavier than believed: gains chosen so that there is a limit to it, on both sides of which the loop is tried.
#[test]
fn mass_margin_is_where_the_loop_starts_to_grow() {
    let params = base("paper-30kg");
    let gains = MotionGains {
        lateral: 8.0,
        longitudinal: 20.0,
        speed_loop: 12.0,
        ..params.gains
    };
    let params = MotionParams { gains, ..params };
    let found = margins::<f64, Libm>(&gains);
    for (across, heavier) in [
        (false, found.longitudinal.heavier),
        (true, found.lateral.heavier),
    ] {
        println!("across {across}: {heavier:.3} times the mass");
        let truth = |share: f64| Truth {
            heavier: share * heavier,
            dt: 1e-3,
            ..AS_BELIEVED
        };
        assert!(heavier > 1.0 && heavier < 100.0);
        assert!(
            !grows(&params, truth(1.0 - NEAR), across),
            "below {heavier}"
        );
        assert!(grows(&params, truth(1.0 + NEAR), across), "above {heavier}");
    }
}

/// Parking by feedback from 1 m with a bearing of 1 mrad: poses half as late as the margin of the bearing's loop let the bearing
/// fall, twice as late they make it grow fivefold. No closer than that: the distance, and with it the loop, is gone
/// within some time constants.
#[test]
fn bearing_grows_beyond_its_delay_margin() {
    let order: Order = Task::Park(Pose::default());
    for (name, params) in BASES
        .into_iter()
        .flat_map(|name| [(name, base(name)), (name, shipped(name))])
    {
        let margin = margins::<f64, Libm>(&params.gains).bearing.pose_delay_s;
        let mut params = params;
        params.arrival.parking = Parking::Feedback;
        let bearing = |share: f64| {
            let truth = Truth {
                pose_late: ticks(margin, share),
                dt: 1e-3,
                ..AS_BELIEVED
            };
            let run = drive(&params, truth, Body::at(-1.0, 1e-3, 0.0), |_| order, 2.0);
            peak(&run, 1.0, 2.0, |now| now.error.1.atan2(now.error.0))
        };
        let (below, above) = (bearing(0.5), bearing(2.0));
        println!(
            "{name}: margin {margin:.3} s, {:.2} and {:.2} mrad of 1",
            1e3 * below,
            1e3 * above
        );
        assert!(below < 1e-3 && above > 5e-3, "{name}: {below} {above}");
    }
}
