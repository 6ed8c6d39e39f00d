//! Scenario files with `controller.kind = "motion"`: the law for a real base.

use super::base::{LimitKeys, RobotKeys, base, pose};
use super::built_in::unless_file;
use super::check::{motion, timing};
use super::file::{self, PoseKeys, Run, Start};
use super::hardware::plant_error;
use super::source::{Checked, Source};
use super::{BuiltInBase, Scenario, ScenarioError, belief, ranges};
use crate::mission::{
    BaseSpec, Change, Course, End, Event, HandOverRule, Mission, Route, VelocityOrder, When,
    check_precision,
};
use crate::motion::ReferenceMotion;
use crate::precision::Precision;
use crate::world::{WorldError, WorldKeys, WorldSetup};
use controller_core::motion::check_order;
use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose, Twist};
use serde::Deserialize;
use std::path::Path;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    description: String,
    run: Run,
    controller: Controller,
    robot: Option<RobotKeys>,
    limits: Option<LimitKeys>,
    #[serde(default)]
    plant: file::Plant,
    #[serde(default)]
    start: Start,
    reference: Option<file::MotionKeys>,
    hand_over: Option<HandOver>,
    goal: Option<PoseKeys>,
    #[serde(default)]
    event: Vec<EventKeys>,
    /// A base by its file, beside the scenario's, instead of `[robot]` and `[limits]`.
    base: Option<String>,
    /// A plant that is not kind, instead of the ideal one.
    world: Option<WorldKeys>,
    /// Of the world's noise.
    seed: Option<u64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Controller {
    #[allow(dead_code)] // `is_motion` has read it.
    kind: String,
    /// Double, or single in a world.
    precision: Option<Precision>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct HandOver {
    time: Option<f64>,
    target_at: Option<f64>,
    target: Option<PoseKeys>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct EventKeys {
    at: f64,
    goal: Option<PoseKeys>,
    jump: Option<PoseKeys>,
    #[serde(default)]
    follow: bool,
    drive: Option<DriveKeys>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DriveKeys {
    #[serde(default)]
    v: f64,
    #[serde(default)]
    w: f64,
    #[serde(default)]
    hold_heading: bool,
}

impl Mission {
    /// Whether a text is a scenario file for the law for a real base.
    pub fn is_motion(text: &str) -> bool {
        Self::kind(text).is_some_and(|kind| kind == "motion")
    }

    /// The law that a scenario file names.
    pub(super) fn kind(text: &str) -> Option<String> {
        let table: toml::Table = toml::from_str(text).ok()?;
        let kind = table.get("controller")?.get("kind")?.as_str()?;
        Some(kind.to_owned())
    }

    /// A mission from the text of a scenario file; `file` is the name that errors show.
    ///
    /// # Errors
    /// Not TOML, an unknown or missing key, a value of the wrong type or out of range, or values
    /// that contradict each other.
    pub fn parse(file: &str, text: &str) -> Result<Self, ScenarioError> {
        let place = Source::new(file, text);
        let keys: File = toml::from_str(text).map_err(|error| place.reader_error(&error))?;
        check_ranges(&keys, &place)?;
        let name = if keys.robot.is_none() && keys.limits.is_none() {
            "30 kg base"
        } else {
            "base of the scenario"
        };
        let base = match &keys.base {
            None => base(
                name.to_owned(),
                keys.robot.as_ref(),
                keys.limits.as_ref(),
                &place,
            )?,
            Some(_) if keys.robot.is_some() || keys.limits.is_some() => {
                return Err(place.error("base", "is a whole base: leave out [robot] and [limits]"));
            }
            Some(named) => named_base(file, named, &place)?,
        };
        if keys.world.is_some() && keys.plant != file::Plant::default() {
            let message = "is the ideal plant's: a [world] says it in [world.body]";
            return Err(place.error("plant", message));
        }
        let robot = belief::true_robot(&base.robot, &keys.plant, &place)?;
        let setup = world_setup(keys.world.as_ref(), keys.seed, &robot, &place)?;
        let precision = keys.controller.precision;
        let precision = precision.unwrap_or(match setup {
            Some(_) => Precision::F32,
            None => Precision::default(),
        });
        check_precision(precision, setup.as_ref())
            .map_err(|error| place.error("controller.precision", error))?;
        let (duration, period_s) = timing(&keys.run, base.motion().max_tick_s, &place)?;
        let start = &keys.start;
        let stem = Path::new(file).file_stem();
        Ok(Self {
            name: stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
            course: course(&keys, duration, &place)?,
            events: events(&keys, duration, &place)?,
            description: keys.description,
            base,
            robot,
            precision,
            start: Measured {
                pose: Pose::new(start.x, start.y, start.theta),
                twist: Twist::new(start.v, start.w),
            },
            period_s,
            end: End::At(duration),
            setup,
        })
    }
}

impl Scenario {
    /// The robot that the controller believes in, with the limits of the default base.
    pub fn believed_base(&self) -> BaseSpec {
        BaseSpec {
            robot: self.params.robot,
            ..BaseSpec::default()
        }
    }

    /// The same course for the default law on `base`, which parks from when the paper's laws do.
    pub fn mission(&self, base: BaseSpec) -> Mission {
        Mission {
            name: self.name.clone(),
            description: self.description.clone(),
            base,
            robot: self.robot,
            precision: self.controller.precision,
            start: self.start,
            course: Course::Follow {
                route: Route::Motion(self.motion),
                hand_over: self.hand_over.map(|plan| HandOverRule {
                    goal: plan.goal,
                    end_s: plan.hand_over_s,
                    when: When::Time(plan.hand_over_s),
                }),
            },
            events: Vec::new(),
            period_s: self.period_s,
            end: End::At(self.duration_s),
            setup: None,
        }
    }
}

/// A base's file beside the scenario's, or one of the built-in bases.
fn named_base(file: &str, named: &str, place: &Source<'_>) -> Checked<BaseSpec> {
    let beside = Path::new(file)
        .parent()
        .unwrap_or(Path::new(""))
        .join(named);
    match unless_file(BuiltInBase::find(named), &beside) {
        Some(base) => base.base(),
        None => BaseSpec::load(&beside).map_err(|error| match error.line {
            // It was not read: what is wrong is its name.
            None => place.error("base", error),
            Some(_) => error,
        }),
    }
}

fn world_setup(
    world: Option<&WorldKeys>,
    seed: Option<u64>,
    robot: &Robot<f64>,
    place: &Source<'_>,
) -> Checked<Option<WorldSetup>> {
    match (world, seed) {
        (None, Some(_)) => Err(place.error("seed", "needs a [world] whose noise it settles")),
        (None, None) => Ok(None),
        (Some(world), seed) => {
            let checked = world.params(robot).check();
            checked.map_err(|error| {
                plant_error(&format!("world.{}", world_key(&error)), &error, place)
            })?;
            Ok(Some(WorldSetup {
                world: world.clone(),
                seed: seed.unwrap_or(1),
            }))
        }
    }
}

/// The key below `[world]` that sets a parameter of the plant: of the body, those are factors on the robot's.
fn world_key(error: &WorldError) -> &str {
    match error.key.as_str() {
        "body.mass_kg" => "body.mass_factor",
        "body.inertia_com_kg_m2" => "body.inertia_factor",
        "body.radius_right_m" => "body.radius_right_factor",
        "body.radius_left_m" => "body.radius_left_factor",
        "body.track_m" => "body.track_factor",
        key => key,
    }
}

fn course(keys: &File, duration: f64, place: &Source<'_>) -> Checked<Course> {
    match (&keys.reference, keys.goal) {
        (Some(_), Some(_)) => {
            let message = "is to be parked at from the start: leave out [reference], or say [hand_over] target";
            Err(place.error("goal", message))
        }
        (None, None) if keys.event.iter().any(|event| event.drive.is_some()) => Ok(Course::Drive),
        (None, None) => {
            let message = "is missing, or a [goal] to park at, or an [[event]] with drive";
            Err(place.error("reference", message))
        }
        (None, Some(goal)) => match keys.hand_over {
            Some(_) => Err(place.error("hand_over", "needs a [reference]")),
            None => Ok(Course::Park(pose(goal))),
        },
        (Some(reference), None) => {
            let motion = motion(reference);
            let hand_over = keys.hand_over.as_ref();
            let rule = hand_over.map(|h| hand_over_rule(h, &motion, duration, place));
            Ok(Course::Follow {
                route: Route::Motion(motion),
                hand_over: rule.transpose()?,
            })
        }
    }
}

fn hand_over_rule(
    keys: &HandOver,
    motion: &ReferenceMotion,
    duration: f64,
    place: &Source<'_>,
) -> Checked<HandOverRule> {
    let outside = |time: &f64| !(*time > 0.0 && *time <= duration);
    if keys.time.as_ref().is_some_and(outside) {
        return Err(place.error("hand_over.time", "must be above 0 and within run.duration"));
    }
    let (goal, end_s) = match (keys.target_at, keys.target, keys.time) {
        (Some(_), Some(_), _) => {
            let message = "says the same as target: leave one of them out";
            return Err(place.error("hand_over.target_at", message));
        }
        (Some(at), None, _) => (ranges::target_at(at, motion, place)?, at),
        (None, Some(target), Some(time)) => (pose(target), time),
        (None, Some(_), None) => {
            let message = "needs a time as well: the way to a pose off the reference is not known";
            return Err(place.error("hand_over.target", message));
        }
        (None, None, _) => {
            let message = "needs target_at (a time on the reference) or target (a pose)";
            return Err(place.error("hand_over", message));
        }
    };
    Ok(HandOverRule {
        goal,
        end_s,
        when: keys.time.map_or(When::Distance, When::Time),
    })
}

fn events(keys: &File, duration: f64, place: &Source<'_>) -> Checked<Vec<Event>> {
    let mut events: Vec<Event> = Vec::new();
    for (number, keys_of) in keys.event.iter().enumerate() {
        let error = |message: &str| Err(place.error(&event_key(number), message));
        let misplaced = |message: &str| {
            let key = format!("{}.at", event_key(number));
            Err(place.error(&key, message))
        };
        if !(0.0..=duration).contains(&keys_of.at) {
            return misplaced("is not within run.duration");
        }
        if events.last().is_some_and(|last| last.at_s > keys_of.at) {
            return misplaced("is before that of the event above it");
        }
        let change = match (keys_of.goal, keys_of.jump, keys_of.follow, keys_of.drive) {
            (Some(goal), None, false, None) => Change::Goal(pose(goal)),
            (None, Some(jump), false, None) => Change::Jump(pose(jump)),
            (None, None, true, None) if keys.reference.is_some() => Change::Follow,
            (None, None, true, None) => return error("follows, but there is no [reference]"),
            (None, None, false, Some(drive)) => {
                for (key, alone) in [("v", [drive.v, 0.0]), ("w", [0.0, drive.w])] {
                    if check_order(&Twist::new(alone[0], alone[1])).is_err() {
                        let key = format!("{}.drive.{key}", event_key(number));
                        return Err(place.error(&key, "must be a number in -100 to 100"));
                    }
                }
                Change::Drive(VelocityOrder {
                    twist: Twist::new(drive.v, drive.w),
                    hold_heading: drive.hold_heading,
                })
            }
            _ => return error("needs one of goal, jump, follow = true, drive"),
        };
        events.push(Event {
            at_s: keys_of.at,
            change,
        });
    }
    Ok(events)
}

/// Of an `[[event]]`.
fn event_key(number: usize) -> String {
    format!("event[{number}]")
}

fn check_ranges(keys: &File, place: &Source<'_>) -> Checked<()> {
    let mut values = ranges::start(&keys.start);
    if let Some(reference) = &keys.reference {
        values.extend(ranges::reference(reference));
    }
    let target = keys.hand_over.as_ref().and_then(|h| h.target);
    let poses = [("goal", keys.goal), ("hand_over.target", target)];
    let poses = poses.map(|(table, keys)| (table.to_owned(), keys));
    let events = keys.event.iter().enumerate();
    let of_events = events.flat_map(|(number, event)| {
        let key = |name| format!("{}.{name}", event_key(number));
        [(key("goal"), event.goal), (key("jump"), event.jump)]
    });
    for (table, keys) in poses.into_iter().chain(of_events) {
        if let Some(PoseKeys { x, y, theta }) = keys {
            values.extend(ranges::pose(&table, x, y, theta));
        }
    }
    ranges::refuse(&values, place)
}
