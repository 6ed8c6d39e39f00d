//! The cases of each class.

use super::minimum::{Pool, change_s};
use super::{Class, Plant, Track};
use crate::drive::{FileError, FileRun};
use crate::mission::{BaseSpec, Change, Course, End, Event, HandOverRule, Mission, VelocityOrder};
use crate::precision::Precision;
use crate::trials::{self, Condition};
use crate::world::{WorldKeys, WorldSetup};
use controller_core::types::{Measured, Pose, Twist};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64Mcg;

/// A trajectory file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackFile<'a> {
    /// For people.
    pub name: &'a str,
    /// Its bytes.
    pub bytes: &'a [u8],
}

macro_rules! files {
    ($($name:literal),*) => {
        /// The files that travel inside the program.
        pub const FILES: &[TrackFile<'static>] = &[$(TrackFile {
            name: $name,
            bytes: include_bytes!(concat!("../../tests/fixtures/", $name)),
        }),*];
    };
}

files![
    "wpilib_gaps.json",
    "wpilib_2027.json",
    "choreo_v1.traj",
    "table.csv"
];

/// How long parking may take \[s\]: ten times the slowest least time.
const PARKING_S: f64 = 40.0;
/// How long a law may take to its goal after a reference's end \[s\].
const AFTER_S: f64 = 20.0;
/// Time between velocity orders \[s\].
const ORDER_S: f64 = 3.0;
/// Ordered shares of the largest speed and turn rate.
const ORDERS: [(f64, f64); 6] = [
    (0.4, 0.0),
    (0.4, 0.3),
    (0.1, -0.3),
    (-0.3, 0.0),
    (0.0, 0.5),
    (0.0, 0.0),
];

/// One thing to drive.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) class: Class,
    /// Index of the base.
    pub(super) base: usize,
    pub(super) course: String,
    pub(super) seed: u64,
    pub(super) mission: Mission,
    /// The least time, of a start or of a file within its tube, limits and pace.
    pub(super) minimum_s: f64,
}

/// A base and its name.
pub type Named = (String, BaseSpec);

/// A file that cannot be driven.
#[derive(Debug, thiserror::Error)]
#[error("{name}: {cause}")]
pub struct BadFile {
    /// Its name.
    pub name: String,
    /// Why.
    pub cause: FileError,
}

/// Cases of a class on a base: `runs` of parking; on plants with noise as many of each other course as fit into `runs`.
pub(super) fn cases(
    class: Class,
    (at, (name, base)): (usize, &Named),
    files: &[TrackFile<'_>],
    runs: usize,
    seed: u64,
) -> Result<Vec<Case>, BadFile> {
    let courses = match class.track {
        Track::Parking => parking(name, base, runs, seed),
        Track::Paper => [trials::Course::Line, trials::Course::Curve]
            .map(|course| paper(course, base))
            .to_vec(),
        Track::Files => {
            let case = |file: &TrackFile<'_>| {
                self::file(file, base).map_err(|cause| BadFile {
                    name: file.name.to_owned(),
                    cause,
                })
            };
            files.iter().map(case).collect::<Result<_, _>>()?
        }
        Track::Velocity => vec![velocity(base)],
    };
    // Parking has a start for each run; other courses are run again in other worlds.
    let worlds = match (class.track, class.plant) {
        (Track::Parking, _) | (_, Plant::Ideal) => 1,
        _ => (runs / courses.len().max(1)).max(1),
    };
    let mut cases = Vec::new();
    for (number, (mission, minimum_s)) in courses.into_iter().enumerate() {
        for world in 0..worlds {
            let own = seed
                .wrapping_mul(1_000_003)
                .wrapping_add((number * worlds + world) as u64);
            let setup = setup(class.plant, base, own);
            cases.push(Case {
                class,
                base: at,
                course: mission.name.clone(),
                seed: own,
                mission: Mission {
                    setup,
                    ..mission.clone()
                },
                minimum_s,
            });
        }
    }
    Ok(cases)
}

/// The world of a plant.
fn setup(plant: Plant, base: &BaseSpec, seed: u64) -> Option<WorldSetup> {
    match plant {
        Plant::Ideal => None,
        Plant::Realistic => Some(realistic(base, seed)),
        Plant::BadFloor => Some(trials::setup(base, Condition::Drawn, seed)),
    }
}

/// The base's own hardware; mass and inertia by themselves within ±30 %, the battery at 80 to 100 %.
fn realistic(base: &BaseSpec, seed: u64) -> WorldSetup {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut draw = |low: f64, high: f64| -> f64 {
        let share: f64 = StandardUniform.sample(&mut random);
        low + (high - low) * share
    };
    let mut world = WorldKeys::default();
    world.body.mass_factor = draw(0.7, 1.3);
    world.body.inertia_factor = draw(0.7, 1.3);
    let left = draw(0.8, 1.0);
    if let Some(hardware) = &base.hardware {
        world.battery = hardware.battery;
        world.battery.open_circuit_v = Some(left * hardware.battery.nominal_v);
    }
    WorldSetup { world, seed }
}

fn mission(name: String, base: &BaseSpec, start: Pose<f64>, course: Course, end: End) -> Mission {
    Mission {
        description: format!("{name} on a {}", base.name),
        name,
        base: base.clone(),
        robot: base.robot,
        precision: Precision::F32,
        start: Measured {
            pose: start,
            twist: Twist::default(),
        },
        course,
        events: Vec::new(),
        period_s: base.period_s(),
        end,
        setup: None,
    }
}

/// Starts from the pool, in an order that the seed draws, mirrored and turned about as it draws: least times stay the same
/// under a mirror, and under exchanging forward and backward.
fn parking(name: &str, base: &BaseSpec, runs: usize, seed: u64) -> Vec<(Mission, f64)> {
    let Some(Pool(mut starts)) = Pool::of(name, base) else {
        return Vec::new();
    };
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    starts.shuffle(&mut random);
    let mut unit = || -> f64 { StandardUniform.sample(&mut random) };
    let drawn = starts.into_iter().take(runs).enumerate();
    let all = drawn.map(|(number, start)| {
        let Pose { x, y, theta } = start.pose;
        let (side, way) = (
            if unit() < 0.5 { 1.0 } else { -1.0 },
            if unit() < 0.5 { 1.0 } else { -1.0 },
        );
        let start_pose = Pose::new(way * x, way * side * y, side * theta);
        let course = Course::Park(Pose::default());
        let name = format!("start {number}");
        let end = End::Parked(PARKING_S);
        (
            mission(name, base, start_pose, course, end),
            start.minimum_s,
        )
    });
    all.collect()
}

/// A case of the paper: the least time is when the reference is at the goal.
fn paper(course: trials::Course, base: &BaseSpec) -> (Mission, f64) {
    let mut mission = course.mission(base);
    let end_s = end_s(&mission);
    mission.end = End::Parked(end_s + AFTER_S);
    (mission, end_s)
}

/// A file: the least time is that of the time-optimal reference within its pace, tube and the limits that references may use.
fn file(file: &TrackFile<'_>, base: &BaseSpec) -> Result<(Mission, f64), FileError> {
    let run = FileRun {
        period_s: base.period_s(),
        ..FileRun::default()
    };
    let (mut mission, _) = run.mission(file.name, file.bytes, base)?;
    let end_s = end_s(&mission);
    mission.end = End::Parked(end_s + AFTER_S);
    Ok((mission, end_s))
}

fn end_s(mission: &Mission) -> f64 {
    match &mission.course {
        Course::Follow {
            hand_over: Some(HandOverRule { end_s, .. }),
            ..
        } => *end_s,
        _ => 0.0,
    }
}

/// Steps of speed and turn rate; the least time is the sum of those of the axis that takes longer.
fn velocity(base: &BaseSpec) -> (Mission, f64) {
    let limits = &base.limits;
    let accel = limits.accel.min(limits.brake);
    let (mut events, mut least, mut before) = (Vec::new(), 0.0, Twist::default());
    for (number, (v, w)) in ORDERS.into_iter().enumerate() {
        let twist = Twist::new(v * limits.speed, w * limits.turn_rate);
        events.push(Event {
            at_s: 0.5 + ORDER_S * number as f64,
            change: Change::Drive(VelocityOrder {
                twist,
                hold_heading: false,
            }),
        });
        let along = change_s(twist.linear - before.linear, accel, limits.jerk);
        let about = change_s(
            twist.angular - before.angular,
            limits.turn_accel,
            limits.turn_jerk,
        );
        least += along.max(about);
        before = twist;
    }
    let end_s = 0.5 + ORDER_S * ORDERS.len() as f64;
    let mission = mission(
        "velocity steps".to_owned(),
        base,
        Pose::default(),
        Course::Drive,
        End::At(end_s),
    );
    (Mission { events, ..mission }, least)
}
