//! The controlled stop in closed loop: it ends within its bounds, and the bounds are not idle.

use std::path::Path;

use controller_core::maths::Libm;
use controller_core::motion::{MotionController, SaturationPolicy, Task, ValidMotionParams};
use controller_core::motor::{coast, electrical_brake};
use controller_core::reference::Reference;
use controller_core::safety::{StopPlan, Stopping, controlled_stop, controlled_stop_distance};
use controller_core::types::{Accel, Measured, Pose, Twist};
use sim_host::closed_loop;
use sim_host::constants::period_us;
use sim_host::mission::BaseSpec as FileBase;
use sim_host::scenario::BASES;
use tests::motion_base::{Base, Body};
use tests::motion_tracking::Exact;
use tests::random::Random;
use tests::stated::{At, Stated};

/// From a twist along a reference that moves so.
fn start(motion: &ValidMotionParams<f64>, twist: Twist<f64>, dt: f64) -> Exact {
    let body = Body {
        pose: Pose::default(),
        twist,
    };
    let task = anew(&body.measured(), twist, Accel::default());
    let controller = MotionController::start(motion, &task, &body.measured()).expect("finite");
    Exact::new(controller, body, Base::of(motion.params()), dt)
}

/// A tick in which a pose is measured that is `off` by so much in x.
fn advance(drive: &mut Exact, off: f64, task: impl Fn(&Measured<f64>) -> Task<f64>) {
    let torques = drive.controller.report().torques;
    let wrench = drive.controller.motion().wheels().wrench(&torques);
    drive.hold(&wrench);
    let mut measured = drive.body.measured::<f64>();
    measured.pose.x += off;
    let step = drive.controller.step(drive.dt, &task(&measured), &measured);
    step.expect("accepted");
}

/// A controlled stop: way, turn, time to rest, and the bounds that were given when it began.
fn stop(drive: &mut Exact) -> (f64, f64, f64, Stopping<f64>) {
    let motion = *drive.controller.motion();
    let report = drive.report();
    let (command, error) = (report.command, drive.body.twist.minus(&report.command));
    let bound = controlled_stop::<f64, Libm>(&motion, &command, &report.command_rate, &error);
    let plan = StopPlan::new::<Libm>(&motion, &command, &report.command_rate);
    drive.controller.declare_jump();
    let (mut way, mut turn, mut rest, mut k) = (0.0, 0.0, 0.0, 0);
    let (mut furthest, mut most) = (0.0_f64, 0.0_f64);
    let dt = drive.dt;
    while f64::from(k) * dt < bound.time_s + 2.0 {
        let t = f64::from(k) * dt;
        let last = drive.body.twist;
        advance(drive, 0.0, |measured| {
            plan.task::<Libm>(t, dt, &measured.pose)
        });
        let twist = drive.body.twist;
        way += dt * (last.linear + twist.linear) / 2.0;
        turn += dt * (last.angular + twist.angular) / 2.0;
        (furthest, most) = (furthest.max(way.abs()), most.max(turn.abs()));
        k += 1;
        // A hundredth of the base's speeds, which time_s promises.
        let limits = &motion.params().limits;
        if twist.linear.abs() > 0.01 * limits.speed || twist.angular.abs() > 0.01 * limits.turn_rate
        {
            rest = f64::from(k) * dt;
        }
    }
    (furthest, most, rest, bound)
}

/// A reference that is anew at the measured pose.
fn anew(measured: &Measured<f64>, twist: Twist<f64>, accel: Accel<f64>) -> Task<f64> {
    Task::Follow(Reference::new_with::<Libm>(measured.pose, twist, accel))
}

/// The bases that come with the project, and a weak one.
fn bases() -> Vec<(String, ValidMotionParams<f64>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bases");
    let mut found = vec![("weak".to_owned(), Base::WEAK.exact())];
    for file in std::fs::read_dir(folder).expect("bases") {
        let base = FileBase::load(&file.expect("a file").path()).expect("a base");
        found.push((base.name.clone(), base.motion()));
    }
    assert!(found.len() >= 4);
    let valid = |(name, params): (String, controller_core::motion::MotionParams<f64>)| {
        (name, params.validate().expect("valid"))
    };
    found.into_iter().map(valid).collect()
}

/// From a steady twist: within the bound, which is less than 1.5 times the way at half the top speed and more.
#[test]
fn bounds_hold_and_are_near_for_every_base_and_speed() {
    for (name, motion) in bases() {
        let limits = motion.params().limits;
        for share in [0.05, 0.2, 0.5, 0.8, 1.0] {
            for dt in [0.001, 0.01] {
                for sign in [1.0, -1.0] {
                    let v = sign * share * limits.speed;
                    let mut drive = start(&motion, Twist::new(v, 0.0), dt);
                    let (way, _, rest, bound) = stop(&mut drive);
                    // The two ticks that the bound does not know of.
                    let late = 2.0 * v.abs() * dt;
                    assert!(
                        way <= bound.distance_m + late,
                        "{name} {v}: {way} of {bound:?}"
                    );
                    assert!(rest <= bound.time_s + dt, "{name} {v}: {rest} of {bound:?}");
                    let straight = controlled_stop_distance::<f64, Libm>(&motion, v);
                    assert!(straight >= bound.distance_m);
                    if share >= 0.5 {
                        println!(
                            "{name} {v:.2} m/s {dt}: {way:.3} m of {:.3}, {rest:.2} s of {:.2}",
                            bound.distance_m, bound.time_s
                        );
                        assert!(
                            bound.distance_m < 1.5 * way,
                            "{name} {v}: {way} of {bound:?}"
                        );
                    }
                }
            }
        }
    }
}

/// From random twists, speeding up or turning in, under all policies, with the jerk of the base and with a tenth of it, which
/// holds back what ends the acceleration under way: 800 stops.
#[test]
fn bounds_hold_for_random_twists_and_accelerations() {
    let mut random = Random(0x5EED_5709);
    let mut ratio = (f64::INFINITY, 0.0_f64);
    for (name, motion) in bases() {
        let policies = [
            SaturationPolicy::KeepCurvature,
            SaturationPolicy::TurnFirst,
            SaturationPolicy::DriveFirst,
        ];
        let each = |jerk: f64| policies.map(|policy| (policy, jerk));
        for (policy, jerk) in [each(1.0), each(0.1)].concat() {
            let mut params = *motion.params();
            params.limits.policy = policy;
            params.limits.jerk *= jerk;
            params.limits.turn_jerk *= jerk;
            // Both axes at their limits at once are within the limits: the bound is for a base that is.
            params.limits.rim_speed =
                params.limits.speed + 0.5 * params.robot.wheels.track_m * params.limits.turn_rate;
            let motion = params.validate().expect("valid");
            let limits = &motion.params().limits;
            for _ in 0..34 {
                let twist =
                    Twist::new(random.within(limits.speed), random.within(limits.turn_rate));
                let accel = Accel::new(
                    random.within(0.5 * limits.accel),
                    random.within(0.5 * limits.turn_accel),
                );
                let mut drive = start(&motion, twist, 0.01);
                // 0.3 s of acceleration, which the stop then meets.
                for k in 0..30 {
                    let t = f64::from(k) * 0.01;
                    let twist = Twist::new(
                        twist.linear + t * accel.linear,
                        twist.angular + t * accel.angular,
                    );
                    advance(&mut drive, 0.0, |measured| anew(measured, twist, accel));
                }
                let (way, turn, _, bound) = stop(&mut drive);
                // Two ticks at no more than the speeds reached by then, and the transition offset's begin.
                let ticks = |speed: f64, accel: f64| {
                    let decay = motion.gains().decay;
                    0.02 * (speed.abs() + 0.32 * accel.abs()) + 0.02 * accel.abs() / decay
                };
                let late = ticks(twist.linear, accel.linear);
                let turned = ticks(twist.angular, accel.angular);
                assert!(
                    way <= bound.distance_m + late,
                    "{name} {twist:?} {accel:?}: {way} of {bound:?}"
                );
                assert!(
                    turn <= bound.angle_rad + turned,
                    "{name} {twist:?} {accel:?}: {turn} of {bound:?}"
                );
                if way > 0.2 * bound.distance_m {
                    ratio = (
                        ratio.0.min(way / bound.distance_m),
                        ratio.1.max(way / bound.distance_m),
                    );
                }
            }
        }
    }
    println!("way over bound: {ratio:.2?}");
    // Not idle: the worst stop uses most of its bound.
    assert!(ratio.1 > 0.9);
}

/// The table of `docs/faults.md`: from top speed, straight on, the base as it is believed to be.
#[test]
fn stopping_distances_from_top_speed_are_those_stated() {
    let mut page = Stated::of("docs/faults.md");
    for built_in in BASES {
        let file = built_in.base().expect("in order");
        let hardware = file.hardware.expect("a base with motors");
        let v = file.limits.speed;
        let motion = file.motion().validate().expect("valid");
        let controlled = controlled_stop_distance::<f64, Libm>(&motion, v);

        let params = closed_loop::params(&file, period_us(&file)).expect("in range");
        let driver = params.driver.motor().expect("motors");
        let valid = driver.validate().expect("in range");
        let slowing = electrical_brake(&valid, &params.motion.robot);
        let slowing = slowing.expect("a robot").linear;
        let shorted = v * f64::from(slowing.time_constant_s().expect("a shorted motor brakes"));
        // Both wheels brake by 2 c at most, c from the current that the driver lets pass.
        let robot = &file.robot;
        let motor = hardware.drivers.motor().expect("motors");
        let radius = robot.wheels.radius_right_m;
        let c = motor.gear_ratio * motor.kt_nm_per_a * motor.current_limit_a / radius;
        // With the rotors, which turn on.
        let mass = file.robot_with_rotors().mass_kg;
        let limited = shorted + v * v / (4.0 * c / mass);

        let energy = 0.5 * mass * v * v;
        let released = energy / (2.0 * hardware.friction.coulomb_nm / radius);
        let rolls = coast(&valid, &params.motion.robot).expect("a robot");
        let rolls = f64::from(rolls.linear.distance(v as f32).expect("friction stops it"));
        // Single precision.
        assert!((rolls / released - 1.0).abs() < 1e-5, "{rolls} {released}");
        page.exactly(
            At::Row("How far", built_in.name),
            &[v, controlled, shorted, limited, released],
        );
    }
}

/// A pose that jumps by half a metre in each tick does not disturb a stop: it goes by the twist.
#[test]
fn a_jumping_pose_does_not_disturb_the_stop() {
    let motion = Base::STANDARD.exact().validate().expect("valid");
    let stop = |wild: f64| {
        let mut drive = start(&motion, Twist::new(1.0, 0.5), 0.01);
        let rate = drive.report().command_rate;
        let plan = StopPlan::new::<Libm>(&motion, &Twist::new(1.0, 0.5), &rate);
        drive.controller.declare_jump();
        let mut random = Random(7);
        for k in 0..300 {
            let t = 0.01 * f64::from(k);
            advance(&mut drive, random.within(wild), |measured| {
                plan.task::<Libm>(t, 0.01, &measured.pose)
            });
        }
        drive.body.pose
    };
    let (calm, wild) = (stop(0.0), stop(0.5));
    assert!((calm.x - wild.x).abs() < 1e-9 && (calm.theta - wild.theta).abs() < 1e-9);
}
