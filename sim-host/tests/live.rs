//! Orders that come while a base runs, on the same loop as missions.

use controller_core::queue::ReferenceQueue;
use controller_core::safety::supervisor::State;
use controller_core::types::{Pose, Twist};
use protocol::Command;
use sim_host::mission::{BaseSpec, Course, VelocityOrder};
use sim_host::run::{Live, LiveLaw, drive_and_observe};
use sim_host::scenario::BuiltInBase;
use sim_host::trials::{self, Condition};
use sim_host::world::{PatchParams, PlantFault, Side, WorldKeys, WorldSetup};

fn base() -> BaseSpec {
    named("lab-10kg")
}

fn named(name: &str) -> BaseSpec {
    let built_in = BuiltInBase::find(name).expect("built in");
    built_in.base().expect("a base")
}

fn as_in_its_file() -> WorldSetup {
    WorldSetup {
        world: WorldKeys::default(),
        seed: 1,
    }
}

fn live<'q>(queue: &'q mut ReferenceQueue<f32, 2>, setup: &WorldSetup, law: LiveLaw) -> Live<'q> {
    Live::new(queue, &base(), setup, Pose::default(), law).expect("a base in a world")
}

fn ticks(live: &mut Live<'_>, seconds: f64) {
    for _ in 0..(100.0 * seconds) as usize {
        live.tick().expect("a tick");
    }
}

#[test]
fn a_mission_ordered_at_the_start_has_the_bits_of_the_mission() {
    let base = base();
    for course in trials::Course::ALL {
        let mission = course.mission(&base);
        let setup = trials::setup(&base, Condition::Drawn, 5);
        let trace = drive_and_observe(&mission, &setup, 1.0).expect("a run");
        assert!(trace.rows.len() > 300);
        let mut queue = ReferenceQueue::new();
        let start = mission.start.pose;
        let mut live =
            Live::new(&mut queue, &base, &setup, start, LiveLaw::Default).expect("a base");
        live.order(mission.course.clone());
        for (tick, row) in trace.rows.iter().enumerate() {
            live.tick().expect("a tick");
            let at = format!("{}, tick {tick}", course.name());
            assert_eq!(live.world().truth(), row.truth, "{at}");
            let asked = live.report().action.torques().unwrap_or_default();
            assert_eq!(row.base.expect("a base").asked, asked.cast(), "{at}");
        }
    }
}

#[test]
fn without_a_host_it_stops_and_with_one_it_goes_on() {
    let mut queue = ReferenceQueue::new();
    let mut live = live(&mut queue, &as_in_its_file(), LiveLaw::Default);
    live.order(Course::Park(Pose::new(3.0, 0.0, 0.0)));
    ticks(&mut live, 2.0);
    assert!(live.world().truth().twist.linear > 0.5);
    live.set_host(false);
    ticks(&mut live, 3.0);
    assert_eq!(live.report().state, State::Stopped);
    assert!(live.world().truth().twist.linear.abs() < 1.0e-3);
    live.set_host(true);
    live.command(&Command::Arm).expect("asked").expect("armed");
    ticks(&mut live, 8.0);
    assert_eq!(live.report().state, State::Parked);
}

#[test]
fn velocity_orders_move_it_until_the_next_order() {
    let mut queue = ReferenceQueue::new();
    let mut live = live(&mut queue, &as_in_its_file(), LiveLaw::Default);
    let order = |speed| VelocityOrder {
        twist: Twist::new(speed, 0.0),
        hold_heading: false,
    };
    live.drive(order(0.3));
    ticks(&mut live, 3.0);
    assert!((live.world().truth().twist.linear - 0.3).abs() < 0.02);
    live.drive(order(-0.2));
    ticks(&mut live, 3.0);
    assert!((live.world().truth().twist.linear + 0.2).abs() < 0.02);
}

/// Where it is put it stands; ordered so, it drives on from there as from anywhere, else it takes external poses for outliers at first.
#[test]
fn a_base_that_is_carried_drives_on_from_there() {
    for announced in [true, false] {
        let mut queue = ReferenceQueue::new();
        let mut live = live(&mut queue, &as_in_its_file(), LiveLaw::Default);
        let goal = Pose::new(1.0, 0.0, 0.0);
        live.order(Course::Park(goal));
        ticks(&mut live, 5.0);
        assert_eq!(live.report().state, State::Parked);
        let there = Pose::new(0.2, -0.4, 1.0);
        live.place(there, announced).expect("asked").expect("taken");
        assert_eq!(live.world().truth().pose, there);
        ticks(&mut live, 0.02);
        let believed = live.report().measured.expect("encoders").pose;
        let off = f64::from(believed.x - 0.2).hypot(f64::from(believed.y + 0.4));
        assert_eq!(off < 0.05, announced, "believes to be {off} m off");
        ticks(&mut live, 15.0);
        let truth = live.world().truth().pose;
        let off = (truth.x - goal.x).hypot(truth.y - goal.y);
        assert!(off < 5.0e-3, "announced {announced}: {off} m off");
    }
}

#[test]
fn pushes_and_ice_act_while_they_last() {
    let mut queue = ReferenceQueue::new();
    let mut live = live(&mut queue, &as_in_its_file(), LiveLaw::Default);
    ticks(&mut live, 0.5);
    // 10 kg, 100 N for 0.1 s: 1 m/s less what rotors, friction and the base itself, which is to stay, hold against it.
    live.world_mut().push([100.0, 0.0, 0.0], 0.1);
    ticks(&mut live, 0.1);
    let pushed = live.world().truth().twist.linear;
    assert!((0.1..1.0).contains(&pushed), "{pushed} m/s");
    ticks(&mut live, 5.0);
    assert!(live.world().truth().twist.linear.abs() < 0.02);
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    live.world_mut().patches().push(PatchParams {
        mu: 0.02,
        x_m: everywhere,
        y_m: everywhere,
        time_s: everywhere,
    });
    live.order(Course::Park(Pose::new(3.0, 0.0, 0.0)));
    ticks(&mut live, 0.6);
    assert!(live.world().slipping().contains(&true));
    live.world_mut().patches().clear();
    ticks(&mut live, 0.1);
    assert_eq!(live.world().slipping(), [false, false]);
    live.world_mut().inject(PlantFault::EncoderFails);
    ticks(&mut live, 0.5);
    assert!(live.report().active_faults.iter().next().is_some());
    live.world_mut().heal(PlantFault::EncoderFails);
    live.world_mut()
        .inject(PlantFault::WheelBlocked(Side::Left));
    ticks(&mut live, 0.5);
    assert!(live.world().wheel_speeds().left.abs() < 1.0e-6);
}

/// The paper's laws reach a goal on the line that ends in it, from beside that line.
#[test]
fn the_laws_of_the_paper_go_to_a_goal_along_a_line() {
    for law in [LiveLaw::Neural, LiveLaw::Plain] {
        let mut queue = ReferenceQueue::new();
        let mut live = live(&mut queue, &as_in_its_file(), law);
        live.order(Course::Park(Pose::new(3.5, 0.5, 0.0)));
        let references = live.references();
        let last = references.last().expect("a line").pose();
        assert!((last.x - 3.5).abs() < 1.0e-9 && (last.y - 0.5).abs() < 1.0e-9);
        ticks(&mut live, 20.0);
        assert!(!live.has_refused());
        let truth = live.world().truth().pose;
        let off = (truth.x - 3.5).hypot(truth.y - 0.5);
        // Their parking leaves what was lateral at the hand-over: 9 to 25 mm here, 50 is theirs by their own figure.
        assert!(off < 0.05, "{law:?}: {off} m");
    }
}

/// Motors that are 3 % apart from their file, one up and one down, on bad floors on which all else is drawn: after four parks of 2 m a base knows
/// which is the stronger one, and by how much: to a tenth, and to a fifth where motors make up for little of what holds a wheel back
/// (`base/motor_bias.rs`). At worst 8 % were missing, and 20 %.
#[test]
fn motors_that_are_not_alike_are_learnt() {
    for (name, missing) in [("paper-30kg", 0.22), ("lab-10kg", 0.1), ("hobby-1kg", 0.1)] {
        let base = named(name);
        for share in [0.03, -0.03] {
            for seed in 1..=20 {
                let mut setup = trials::setup(&base, Condition::Drawn, seed);
                setup.world.motor.as_mut().expect("motors").strength = [1.0 + share, 1.0 - share];
                let mut queue = ReferenceQueue::new();
                let mut live =
                    Live::new(&mut queue, &base, &setup, Pose::default(), LiveLaw::Default)
                        .expect("a base in a world");
                for x in [2.0, 0.0, 2.0, 0.0] {
                    live.order(Course::Park(Pose::new(x, 0.0, 0.0)));
                    let ticks = (8.0 / base.period_s()) as usize;
                    for _ in 0..ticks {
                        live.tick().expect("a tick");
                    }
                }
                let found = f64::from(live.report().motor_bias) / share;
                let at = format!("{name}, {share}, seed {seed}: {found}");
                assert!((found - 1.0).abs() < missing, "{at}");
            }
        }
    }
}
