//! Detectors in closed loop: what breaks is found in time, and the base is stopped before it has gone far.

use controller_core::hal::WheelCounts;
use controller_core::safety::supervisor::State;
use controller_core::safety::{
    DetectorInputs, DetectorParams, Fault, FaultKind, Monitor, Reaction, Side, Timeout,
};
use controller_core::types::{Twist, WheelTorques};
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Order, steady};
use tests::safety_rig::{BRAKE_TAU, COUNTS, Encoder, Rig};

const BASE: Base = Base::STANDARD;

fn path() -> impl Fn(f64) -> Order + Sync + Copy {
    steady(0.4, 0.15)
}

/// One or both encoders reversed, from rest and on the move, at two tick lengths.
///
/// The velocity loop has to drive the base until the torque is a multiple of the load, which it does at a rate
/// of 3/s, whatever the command was; then the window of 0.1 s has to fill, and the brake to work.
#[test]
fn reversed_encoders_are_found_before_the_base_has_gone_far() {
    use Encoder::{Reversed, Sound};
    let mut worst = (0.0_f64, 0.0_f64);
    for dt in [0.01, 0.001] {
        for v in [0.05, 0.4, 1.0] {
            for encoders in [[Reversed, Reversed], [Reversed, Sound], [Sound, Reversed]] {
                for moving in [false, true] {
                    let order = steady(v, 0.0);
                    let mut body = Body::default();
                    if moving {
                        body.twist = Twist::new(v, 0.0);
                    }
                    let mut rig = Rig::start(BASE, body, &order(0.0), dt);
                    rig.encoders = encoders;
                    rig.run(8.0, order);
                    let at = rig.found_at(FaultKind::EncoderReversed);
                    println!(
                        "{v} m/s {encoders:?} moving {moving} {dt}: {at:?} s {:.3} m",
                        rig.way
                    );
                    let at = at.expect("found");
                    worst = (worst.0.max(at), worst.1.max(rig.way));
                    assert_eq!(rig.supervisor.state(), State::Fault);
                }
            }
        }
    }
    println!(
        "reversed: found within {:.2} s, at rest within {:.2} m",
        worst.0, worst.1
    );
    // Measured: 0.53 s and 0.45 m at worst, and a tenth.
    assert!(worst.0 < 0.58 && worst.1 < 0.5, "{worst:?}");
}

/// An encoder that dies on the way is named, and no other: within the 0.25 s of torque without counts that it takes at
/// most, two ticks, and a brake of 0.15 s.
#[test]
fn dead_encoders_are_found_and_braked() {
    use Encoder::{Sound, Stuck};
    for (encoders, side) in [
        ([Stuck, Stuck], Side::Right),
        ([Stuck, Sound], Side::Right),
        ([Sound, Stuck], Side::Left),
    ] {
        let order = path();
        let mut rig = Rig::start(BASE, Body::default(), &order(0.0), 0.01);
        rig.run(10.0, order);
        assert_eq!(rig.found, []);
        rig.encoders = encoders;
        let before = rig.way;
        rig.run(20.0, order);
        let (found, first) = rig.found[0];
        assert_eq!(first, Fault::EncoderStuck(side));
        let found = found - 10.0;
        let way = rig.way - before;
        println!("{encoders:?}: {found:.2} s, {way:.2} m, {:?}", rig.found);
        assert!(found < 0.275, "{found}");
        // The blind velocity loop doubles the speed at most until then, and the brake takes v τ.
        assert!(way < 0.8 * (0.275 + BRAKE_TAU), "{way}");
        assert_eq!(rig.supervisor.state(), State::Fault);
        assert!(rig.drive.body.twist.linear.abs() < 1e-6);
    }
}

/// The left wheel on ice: the velocity loop holds it at its speed while the base turns away; against the true
/// twist that shows before 0.2 m/s are lost.
#[test]
fn a_wheel_without_grip_is_found_against_the_true_twist() {
    let order = steady(1.0, 0.0);
    let mut rig = Rig::start(BASE, Body::default(), &order(0.0), 0.01);
    rig.outside = true;
    rig.run(0.5, order);
    assert_eq!(rig.found, []);
    rig.ice = Some(rig.drive.body.twist.linear / 0.1);
    rig.run(6.0, order);
    let found = rig.found_at(FaultKind::WheelSlip).expect("found") - 0.5;
    println!("slip found after {found:.2} s");
    assert!(found < 1.0, "{found}");
}

/// A tick is too long from ten periods on, and no less than the 50 ms that are ten of a loop of 200 Hz: gains of faster loops are no quicker.
#[test]
fn ticks_of_fast_loops_may_be_as_long_as_those_of_200_hz() {
    for (period_us, most_us) in [(20_000, 200_000), (5_000, 50_000), (1_000, 50_000)] {
        let settings = DetectorParams::for_base(&BASE.exact(), COUNTS, period_us);
        assert_eq!(settings.ticks.long, Timeout::AfterUs(most_us));
    }
}

/// A wheel that spins up under 4 N m as only its own inertia of 0.015 kg m² can: from torque and counts alone.
#[test]
fn a_wheel_that_spins_up_is_found_by_its_torque() {
    let settings = DetectorParams::for_base(&BASE.exact(), COUNTS, 10_000);
    let mut monitor = Monitor::new(&settings.validate().expect("valid"));
    let found = (0..100).find(|k| {
        let t = 0.01 * f64::from(*k);
        // The right wheel has grip and moves the base: 40 N on 30 kg, no turn to keep it simple.
        let turn = |accel: f64| (0.5 * accel * t * t * COUNTS / std::f64::consts::TAU) as i32;
        let found = monitor.check(&DetectorInputs {
            dt_us: 10_000,
            counts: Some(WheelCounts {
                right: turn(15.0),
                left: turn(4.0 / 0.015),
            }),
            torques: Some(WheelTorques {
                right: 4.0,
                left: 4.0,
            }),
            ..DetectorInputs::default()
        });
        found.get(FaultKind::WheelSlip) == Some(Fault::WheelSlip(Side::Left))
    });
    let found = found.expect("found");
    println!("spinning wheel found after {found} ticks of 10 ms");
    // The window of 0.1 s and the 50 ms on top, with room for half a window.
    assert!(found <= 20, "{found}");
}

/// Without torque there is no evidence in the wheels, but an outside twist tells.
#[test]
fn slip_shows_against_an_outside_twist() {
    let order = steady(0.5, 0.0);
    let mut rig = Rig::start(BASE, Body::default(), &order(0.0), 0.01);
    rig.edit = |t, inputs| {
        let slower = if t > 5.0 { 0.25 } else { 0.0 };
        let v = inputs.measured.twist.linear - slower;
        inputs.outside = Some(Twist::new(v, inputs.measured.twist.angular));
    };
    rig.run(8.0, order);
    let found = rig.found_at(FaultKind::WheelSlip).expect("found");
    assert!((5.0..5.1).contains(&found), "{found}");
}

/// A wall: the wheels stand, and so says the outside twist. Not an encoder's fault.
#[test]
fn a_blocked_base_is_stalled_and_not_blind() {
    let order = steady(0.4, 0.0);
    let mut rig = Rig::start(BASE, Body::default(), &order(0.0), 0.01);
    rig.edit = |_, inputs| inputs.outside = Some(Twist::default());
    rig.drive.plant.mass = 1e9;
    rig.drive.plant.inertia = 1e9;
    rig.run(10.0, order);
    assert!(
        rig.found_at(FaultKind::Stalled).is_some(),
        "{:?}",
        rig.found
    );
    assert_eq!(rig.found_at(FaultKind::EncoderStuck), None);
    assert_eq!(rig.supervisor.state(), State::Stopped, "may be armed again");
}

/// A battery that sags for 50 ms is let be; one that stays low ends in a controlled stop, latched.
#[test]
fn a_low_supply_ends_in_a_controlled_stop() {
    let order = path();
    let mut rig = Rig::start(BASE, Body::default(), &order(0.0), 0.01);
    let mut settings = DetectorParams::for_base(rig.motion().params(), COUNTS, 10_000);
    settings.supply.after = Timeout::AfterUs(100_000);
    rig.set_detectors(&settings.validate().expect("valid"));
    rig.edit = |t, inputs| {
        let sags = (4.0..4.05).contains(&t) || t > 6.0;
        inputs.supply_v = Some(if sags { 9.0 } else { 12.0 });
    };
    rig.run(6.05, order);
    assert_eq!(rig.found, []);
    rig.run(6.2, order);
    let found = rig.found_at(FaultKind::UnderVoltage).expect("found");
    assert!((6.1..6.13).contains(&found), "{found}");
    assert!(matches!(rig.supervisor.state(), State::Stopping(_)));
    rig.run(12.0, order);
    assert_eq!(rig.supervisor.state(), State::Fault);
    assert!(rig.drive.body.twist.linear.abs() < 0.01);
}

/// An electrical brake of time constant τ stops within v τ of where it set in.
#[test]
fn the_electrical_brake_stops_within_speed_times_time_constant() {
    let order = steady(1.0, 0.0);
    let mut rig = Rig::start(BASE, Body::default(), &order(0.0), 0.001);
    rig.run(6.0, order);
    let (v, before) = (rig.drive.body.twist.linear, rig.way);
    rig.supervisor.emergency_stop();
    assert_eq!(rig.supervisor.output().severity(), Reaction::Brake);
    while rig.supervisor.state() != State::Fault {
        let next = rig.drive.t + 0.001;
        rig.run(next, order);
    }
    // A tick at full speed before the brake is felt, and half a one by the plant's steps.
    let bound = v * (BRAKE_TAU + 0.002);
    assert!(rig.way - before < bound, "{} of {bound}", rig.way - before);
    assert!(rig.way - before > 0.9 * v * BRAKE_TAU);
}
