//! The tick of a whole base: what it does with what it is given, and with what it is not.

use controller_core::base::{BaseController, BaseReport, Order, Sensed, WheelAction};
use controller_core::hal::WheelCounts;
use controller_core::localiser::FixOutcome;
use controller_core::queue::ReferenceQueue;
use controller_core::reference::Reference;
use controller_core::safety::supervisor::{Cause, State, Then};
use controller_core::safety::{Fault, FaultKind};
use controller_core::types::{Accel, Measured, Pose, Twist, WheelTorques};
use firmware_demo::mission;
use protocol::{Command, RejectReason};
use sim_host::closed_loop::ClosedLoop;
use sim_host::mission::Mission;
use sim_host::world::PlantFault;
use sim_host::world::WorldSetup;

const DT: f32 = 0.01;

/// The 10 kg base on an ideal floor, with its motors, encoders and pose source, but without their noise.
fn closed_loop(queue: &mut ReferenceQueue<f32, 2>) -> ClosedLoop<'_> {
    let text = "base = \"lab-10kg\"\n[run]\nduration = 10.0\nperiod = 0.01\n[controller]\nkind = \"motion\"\n\
                [goal]\nx = 1.0\n[world.pose_source]\nrate_hz = 20.0\n";
    let mission = Mission::parse("base.toml", text).expect("valid");
    let setup: WorldSetup = mission.setup.clone().expect("a world");
    ClosedLoop::new(queue.split().1, &mission, &setup, None).expect("valid")
}

fn step(closed_loop: &mut ClosedLoop<'_>, order: &Order<f32>) -> BaseReport<f32> {
    closed_loop
        .advance()
        .expect("a world takes what a base commands");
    *closed_loop.tick(order).expect("no mirror")
}

fn command(closed_loop: &mut ClosedLoop<'_>, command: &Command) -> Result<(), RejectReason> {
    closed_loop.command(command).expect("no mirror")
}

/// A straight reference at 0.4 m/s, at time `t`.
fn line(t: f32) -> Order<f32> {
    let pose = Pose::new(0.4 * t, 0.0, 0.0);
    Order::Follow(Reference::new_with::<controller_core::maths::Single>(
        pose,
        Twist::new(0.4, 0.0),
        Accel::default(),
    ))
}

/// Armed and following for `ticks`; the tick's number to go on with.
fn following(closed_loop: &mut ClosedLoop<'_>, ticks: u16) -> u16 {
    step(closed_loop, &Order::None);
    command(closed_loop, &Command::Arm).expect("idle");
    for tick in 0..ticks {
        let report = step(closed_loop, &line(DT * f32::from(tick)));
        assert_eq!(report.state, State::Tracking);
    }
    ticks
}

fn largest(torques: &WheelTorques<f32>) -> f32 {
    torques.right.abs().max(torques.left.abs())
}

/// The firmware's protocol lets no such order through; the base stops by itself.
#[test]
fn an_order_that_is_not_a_number_brakes_and_latches() {
    let nowhere = Pose::new(f32::NAN, 0.0, 0.0);
    let along = Reference::new(nowhere, Twist::new(0.4, 0.0), Accel::default());
    let drive = Order::Drive {
        twist: Twist::new(f32::NAN, 0.0),
        hold_heading: false,
    };
    for order in [Order::Park(nowhere), Order::Follow(along), drive] {
        let mut queue = ReferenceQueue::new();
        let mut closed_loop = closed_loop(&mut queue);
        following(&mut closed_loop, 100);
        let report = step(&mut closed_loop, &order);
        assert_eq!(report.action, WheelAction::Brake);
        assert_eq!(report.state, State::Braking(Then::Fault));
        let Cause::Fault(fault) = report.cause else {
            panic!("{:?}", report.cause);
        };
        assert_eq!(fault.kind(), FaultKind::NotFinite);
    }
}

#[test]
fn nothing_moves_before_it_is_armed() {
    let mut queue = ReferenceQueue::new();
    let mut closed_loop = closed_loop(&mut queue);
    for tick in 0..50 {
        let report = step(&mut closed_loop, &line(DT * tick as f32));
        assert_eq!(report.action, WheelAction::Release);
        assert!(report.refused && report.motion.is_none());
        assert_eq!(report.state, State::Idle);
    }
}

#[test]
fn arming_holds_zero_torque_and_the_first_torque_is_zero() {
    let mut queue = ReferenceQueue::new();
    let mut closed_loop = closed_loop(&mut queue);
    step(&mut closed_loop, &Order::None);
    command(&mut closed_loop, &Command::Arm).expect("idle");
    let armed = step(&mut closed_loop, &Order::None);
    assert_eq!(armed.action.torques(), Some(WheelTorques::default()));
    let first = step(&mut closed_loop, &line(0.0));
    assert_eq!(first.state, State::Tracking);
    assert_eq!(first.action.torques(), Some(WheelTorques::default()));
}

/// Two readings lost: the pose goes on along its arc, and the counts of the gap are all there afterwards.
#[test]
fn lost_readings_are_ignored_and_made_up_for() {
    let mut queue = ReferenceQueue::new();
    let mut closed_loop = closed_loop(&mut queue);
    let mut tick = following(&mut closed_loop, 300);
    closed_loop.world_mut().inject(PlantFault::EncoderFails);
    for _ in 0..2 {
        let report = step(&mut closed_loop, &line(DT * f32::from(tick)));
        assert!(report.blind && report.active_faults.is_empty());
        tick += 1;
    }
    closed_loop.world_mut().heal(PlantFault::EncoderFails);
    let report = step(&mut closed_loop, &line(DT * f32::from(tick)));
    let seen = report.measured.expect("measured").pose;
    let truth = closed_loop.world().truth().pose;
    // A count is 0.23 mm; the pose source has no noise, and its corrections are slower than this.
    assert!(
        (f64::from(seen.x) - truth.x).abs() < 1e-3,
        "{seen:?} {truth:?}"
    );
    assert_eq!(report.state, State::Tracking);
}

#[test]
fn encoders_that_stay_silent_brake_the_base_for_good() {
    let mut queue = ReferenceQueue::new();
    let mut closed_loop = closed_loop(&mut queue);
    let mut tick = following(&mut closed_loop, 300);
    closed_loop.world_mut().inject(PlantFault::EncoderFails);
    let found = (0..20).find_map(|lost| {
        let report = step(&mut closed_loop, &line(DT * f32::from(tick)));
        tick += 1;
        let stale = report.active_faults.get(FaultKind::MeasurementStale);
        stale.map(|_| (lost, report))
    });
    let (lost, report) = found.expect("found");
    // Five readings, and it is in the tick of the fifth that the wheels are braked.
    assert_eq!(lost, 4);
    assert_eq!(report.action, WheelAction::Brake);
    assert_eq!(report.cause, Cause::Fault(Fault::MeasurementStale));
    for _ in 0..600 {
        step(&mut closed_loop, &Order::None);
    }
    assert_eq!(closed_loop.report().state, State::Fault);
    assert!(closed_loop.world().truth().twist.linear.abs() < 1e-3);
}

/// Once they move nothing; if they last they are encoders that fail.
#[test]
fn counts_that_no_wheel_comes_to_are_no_reading() {
    let (base, _) = mission::base(false).expect("in range");
    let mut controller: BaseController = BaseController::new(&base, Pose::default());
    let mut tick = |right| {
        let sensed = Sensed::of_counts(WheelCounts { right, left: 0 });
        *controller.tick(mission::PERIOD_US, &Order::None, &sensed)
    };
    for (right, blind) in [
        (0, false),
        (0, false),
        (1 << 20, true),
        (0, true),
        (0, false),
    ] {
        let report = tick(right);
        assert_eq!(report.blind, blind);
        assert!(report.active_faults.is_empty());
        assert_eq!(report.measured, Some(Measured::default()));
    }
    for lost in 0..10 {
        let report = tick(if lost % 2 == 0 { 1 << 20 } else { 0 });
        let stale = report.active_faults.get(FaultKind::MeasurementStale);
        // Five readings, as above.
        assert_eq!(stale.is_some(), lost >= 4, "{lost}");
    }
}

#[test]
fn a_silent_host_stops_the_base_within_its_limits() {
    let mut queue = ReferenceQueue::new();
    let mut closed_loop = closed_loop(&mut queue);
    following(&mut closed_loop, 300);
    let mut stopping = 0;
    for _ in 0..400 {
        let report = step(&mut closed_loop, &Order::None);
        if let State::Stopping(_) = report.state {
            stopping += 1;
            let motion = report.motion.expect("the law brakes");
            // 1.5 m/s² of the base; its loop adds what it needs for errors.
            assert!(motion.command_rate.linear > -1.5 - 1e-4);
        }
    }
    let report = closed_loop.report();
    assert_eq!(report.state, State::Stopped);
    assert_eq!(report.cause, Cause::Fault(Fault::CommandStale));
    assert!(stopping > 20 && closed_loop.world().truth().twist.linear.abs() < 0.01);
}

#[test]
fn the_button_reaches_the_wheels_at_once_and_is_latched() {
    let mut queue = ReferenceQueue::new();
    let mut closed_loop = closed_loop(&mut queue);
    following(&mut closed_loop, 300);
    let brake = Command::EmergencyStop { brake: true };
    command(&mut closed_loop, &brake).expect("never refused");
    assert_eq!(closed_loop.task().output(), &WheelAction::Brake);
    let report = step(&mut closed_loop, &line(3.0));
    assert_eq!(report.action, WheelAction::Brake);
    assert!(report.refused);
    // Not before it is reset.
    assert_eq!(
        command(&mut closed_loop, &Command::Arm),
        Err(RejectReason::State)
    );
    for _ in 0..600 {
        step(&mut closed_loop, &Order::None);
    }
    assert_eq!(closed_loop.report().state, State::Fault);
    command(&mut closed_loop, &Command::ResetFault).expect("at rest");
    assert_eq!(step(&mut closed_loop, &Order::None).state, State::Idle);
}

/// Poses that are no numbers are refused by name, and the base goes on by odometry.
#[test]
fn a_pose_that_is_no_number_changes_nothing() {
    let mut queue = ReferenceQueue::new();
    let mut closed_loop = closed_loop(&mut queue);
    let from = following(&mut closed_loop, 100);
    closed_loop.world_mut().inject(PlantFault::PoseNan);
    let mut refused = 0;
    for tick in from..from + 50 {
        let report = step(&mut closed_loop, &line(DT * f32::from(tick)));
        refused += usize::from(matches!(report.fix, FixOutcome::Refused(_)));
        assert_eq!(report.state, State::Tracking);
        let torques = report.action.torques().expect("driven");
        assert!(largest(&torques).is_finite());
    }
    // 20 a second for half a second, the first of them taken before the fault.
    assert!((9..=10).contains(&refused), "{refused}");
}

/// The map is moved by half a metre: the torque goes on from where it was.
#[test]
fn a_pose_that_is_set_makes_no_step_of_the_torque() {
    let mut queue = ReferenceQueue::new();
    let mut closed_loop = closed_loop(&mut queue);
    let mut tick = following(&mut closed_loop, 300);
    let before = closed_loop.report().action.torques().expect("driven");
    let Measured { pose, .. } = closed_loop.report().measured.expect("measured");
    let moved = Pose::new(pose.x - 0.3, pose.y + 0.4, pose.theta);
    let moved = (&moved).into();
    command(&mut closed_loop, &Command::SetPose { pose: moved }).expect("finite");
    let report = step(&mut closed_loop, &line(DT * f32::from(tick)));
    tick += 1;
    let after = report.action.torques().expect("driven");
    let motion = closed_loop.task().controller().base().motion();
    // Both wheels' share of the limits on the rates of force and moment, and a count's worth of speed.
    let wheels = motion.wheels();
    let most = wheels.torques(&controller_core::types::Wrench {
        force: motion.force_rate_limit() * DT,
        moment: motion.moment_rate_limit() * DT,
    });
    let change = (after.right - before.right)
        .abs()
        .max((after.left - before.left).abs());
    assert!(change <= largest(&most), "{change} {most:?}");
    let motion = step(&mut closed_loop, &line(DT * f32::from(tick))).motion;
    // The law sees the new place: 0.4 m to the left.
    assert!(motion.expect("driven").error.y < -0.3);
}

/// A parked base whose goal turns out to be elsewhere drives there, and says that it does; one that is there again
/// says that too.
#[test]
fn a_parked_base_that_leaves_its_goal_says_so() {
    let mut queue = ReferenceQueue::new();
    let mut closed_loop = closed_loop(&mut queue);
    step(&mut closed_loop, &Order::None);
    command(&mut closed_loop, &Command::Arm).expect("idle");
    let goal = Order::Park(Pose::default());
    let until = |closed_loop: &mut ClosedLoop<'_>, state: State| {
        let mut reports = (0..2_000).map(|_| step(closed_loop, &goal));
        reports.any(|report| report.state == state)
    };
    assert!(until(&mut closed_loop, State::Parked));
    // The first second after arrival is for settling.
    for _ in 0..150 {
        assert_eq!(step(&mut closed_loop, &goal).state, State::Parked);
    }
    // 0.2 m: the pose source puts it back, but only after a while.
    let moved = (&Pose::new(0.2, 0.0, 0.0)).into();
    assert_eq!(
        command(&mut closed_loop, &Command::SetPose { pose: moved }),
        Ok(())
    );
    assert_eq!(step(&mut closed_loop, &goal).state, State::Parking);
    assert!(until(&mut closed_loop, State::Parked));
}
