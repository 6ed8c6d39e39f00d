//! What a robot is to do.

use crate::robot::{Robot, texts};
use crate::trajectory::{Trajectory, retiming};
use crate::{arguments, error};
use controller_core::types::{Measured, Pose, Twist};
use pyo3::prelude::*;
use sim_host::advice::of_job;
use sim_host::drive::FileRun;
use sim_host::job::{Content, Job};
use sim_host::mission::{BaseSpec, Course, End, Mission as Plan, check_length, check_precision};
use sim_host::precision::Precision;
use sim_host::scenario::{ControlLaw, FAR};
use sim_host::trials::{self, Condition};
use sim_host::world::{WorldKeys, WorldSetup};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a robot is to do, read and checked: a scenario, a trajectory file, or a way to a goal.
#[pyclass(module = "twb", frozen)]
pub struct Mission {
    pub job: Arc<Job>,
}

/// The worlds of `verify`, by name.
const WORLDS: [(&str, Condition); 6] = [
    ("drawn", Condition::Drawn),
    ("light", Condition::Light),
    ("heavy", Condition::Heavy),
    ("wide", Condition::Wide),
    ("narrow", Condition::Narrow),
    ("low-battery", Condition::LowBattery),
];
/// The robot's own hardware on a perfect floor.
const EVEN: &str = "even";

/// A world by its name; none is the ideal plant.
pub fn world(base: &BaseSpec, name: Option<&str>, seed: u64) -> PyResult<Option<WorldSetup>> {
    let Some(name) = name else { return Ok(None) };
    if name == EVEN {
        let world = WorldKeys::default();
        return Ok(Some(WorldSetup { world, seed }));
    }
    match WORLDS.iter().find(|(word, _)| *word == name) {
        Some((_, condition)) => Ok(Some(trials::setup(base, *condition, seed))),
        None => {
            let names = WORLDS.map(|(word, _)| word).join(", ");
            let message = format!("no world is named {name}: there are {EVEN}, {names}");
            Err(error::argument("world", &message))
        }
    }
}

fn precision(name: &str) -> PyResult<Precision> {
    match name {
        "f32" => Ok(Precision::F32),
        "f64" => Ok(Precision::F64),
        other => {
            let message = format!("precision is {other}: it must be f32 or f64");
            Err(error::argument("precision", &message))
        }
    }
}

/// Refuses a precision that nothing computes in.
fn allowed(precision: Precision, setup: Option<&WorldSetup>) -> PyResult<()> {
    let checked = check_precision(precision, setup);
    checked.map_err(|e| error::argument("precision", &format!("precision \"f64\" {e}")))
}

/// A pose within what scenario files may say.
pub fn pose(key: &str, [x, y, theta]: [f64; 3]) -> PyResult<Pose<f64>> {
    if [x, y, theta].iter().all(|v| (-FAR..=FAR).contains(v)) {
        Ok(Pose::new(x, y, theta))
    } else {
        let message = format!("{key} must have numbers in -{FAR:e} to {FAR:e}");
        Err(error::argument(key, &message))
    }
}

impl Mission {
    fn of(job: Job) -> Self {
        Self { job: Arc::new(job) }
    }

    fn under(job: Job, law: &str, robot: Option<&Robot>) -> PyResult<Job> {
        let Job::Scenario(scenario) = &job else {
            return match law {
                "motion" => Ok(job),
                _ => {
                    let message = format!("{}: is for the default law", job.name());
                    Err(error::argument("law", &message))
                }
            };
        };
        Ok(match law {
            "neural" => Job::Scenario(Box::new(scenario.with_law(ControlLaw::Neural))),
            "plain" => Job::Scenario(Box::new(scenario.with_law(ControlLaw::Plain))),
            "motion" => {
                let base = robot.map(|robot| robot.file.base.clone());
                let base = base.unwrap_or_else(|| scenario.believed_base());
                Job::Mission {
                    mission: Box::new(scenario.mission(base)),
                    file: None,
                }
            }
            other => {
                let message = format!("law is {other}: it must be neural, plain or motion");
                return Err(error::argument("law", &message));
            }
        })
    }

    /// The same in a world.
    fn within(mut job: Job, name: Option<&str>, seed: u64) -> PyResult<Job> {
        if name.is_none() {
            return Ok(job);
        }
        match &mut job {
            Job::Mission { mission, .. } => {
                mission.setup = world(&mission.base, name, seed)?;
                allowed(mission.precision, mission.setup.as_ref())?;
                Ok(job)
            }
            Job::Scenario(_) => {
                let message = "the paper's laws run on the ideal plant: choose law=\"motion\"";
                Err(error::argument("world", message))
            }
        }
    }
}

#[pymethods]
impl Mission {
    /// A scenario or trajectory file, or a shipped scenario; options but for `law`, `world` and `seed` are for
    /// trajectory files, and `robot` for them and for a scenario of the paper under law="motion".
    #[staticmethod]
    #[pyo3(signature = (path, *, robot = None, law = None, world = None, seed = 1, offset_m = None, fastest = false,
        tolerance_m = None, precision = "f32", period_s = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn load(
        py: Python<'_>,
        path: PathBuf,
        robot: Option<&Robot>,
        law: Option<&str>,
        world: Option<&str>,
        #[pyo3(from_py_with = arguments::seed)] seed: u64,
        offset_m: Option<f64>,
        fastest: bool,
        tolerance_m: Option<f64>,
        precision: &str,
        period_s: Option<f64>,
    ) -> PyResult<Self> {
        let content = Content::read(&path).map_err(|e| error::job(&e))?;
        match content {
            Content::Scenario { file, text } => {
                let given = [
                    ("offset_m", offset_m.is_some()),
                    ("fastest", fastest),
                    ("tolerance_m", tolerance_m.is_some()),
                    ("precision", precision != "f32"),
                    ("period_s", period_s.is_some()),
                ];
                if let Some((key, _)) = given.iter().find(|(_, given)| *given) {
                    let message =
                        format!("{key} is for trajectory files: a scenario says it itself");
                    return Err(error::argument(key, &message));
                }
                Self::parse(&text, &file, robot, law, world, seed)
            }
            Content::Trajectory { bytes, .. } => {
                let trajectory = Trajectory::of(&path, bytes, tolerance_m)?;
                Self::follow(
                    py,
                    &trajectory,
                    robot,
                    world,
                    seed,
                    offset_m,
                    fastest,
                    tolerance_m,
                    precision,
                    period_s,
                )
            }
        }
    }

    /// A scenario from its text; `file` is the name that errors show.
    #[staticmethod]
    #[pyo3(signature = (text, file = "scenario.toml", *, robot = None, law = None, world = None, seed = 1))]
    fn parse(
        text: &str,
        file: &str,
        robot: Option<&Robot>,
        law: Option<&str>,
        world: Option<&str>,
        #[pyo3(from_py_with = arguments::seed)] seed: u64,
    ) -> PyResult<Self> {
        let mut job = Job::parse(file, text).map_err(|e| error::scenario(&e))?;
        if robot.is_some() && (law != Some("motion") || job.scenario().is_none()) {
            let message = "a scenario names its robot itself: one of the paper's takes another with law=\"motion\"";
            return Err(error::argument("robot", message));
        }
        let of_paper = job.scenario().is_some();
        if let Some(law) = law {
            job = Self::under(job, law, robot)?;
        }
        if let (Job::Mission { mission, .. }, true, Some(_)) = (&mut job, of_paper, world) {
            // The file says what the paper's laws compute in.
            mission.precision = Precision::F32;
        }
        Ok(Self::of(Self::within(job, world, seed)?))
    }

    /// Along a trajectory file, and parked at its end.
    #[staticmethod]
    #[pyo3(signature = (trajectory, *, robot = None, world = None, seed = 1, offset_m = None, fastest = false,
        tolerance_m = None, precision = "f32", period_s = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn follow(
        py: Python<'_>,
        trajectory: &Trajectory,
        robot: Option<&Robot>,
        world: Option<&str>,
        #[pyo3(from_py_with = arguments::seed)] seed: u64,
        offset_m: Option<f64>,
        fastest: bool,
        tolerance_m: Option<f64>,
        precision: &str,
        period_s: Option<f64>,
    ) -> PyResult<Self> {
        let base = robot.map_or_else(BaseSpec::default, |robot| robot.file.base.clone());
        let run = FileRun {
            offset_m,
            retiming: retiming(fastest, tolerance_m),
            precision: self::precision(precision)?,
            period_s: period_s.unwrap_or(base.period_s()),
        };
        let name = &trajectory.name;
        let job = py.detach(|| Job::follow(name, &trajectory.bytes, &run, &base));
        let job = job.map_err(|e| error::trajectory(Path::new(name), &e))?;
        Ok(Self::of(Self::within(job, world, seed)?))
    }

    /// From rest at a pose to another, and parked there.
    #[staticmethod]
    #[pyo3(signature = (start, goal, *, robot = None, world = None, seed = 1, precision = "f32", period_s = None,
        longest_s = 60.0))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn park(
        start: [f64; 3],
        goal: [f64; 3],
        robot: Option<&Robot>,
        world: Option<&str>,
        #[pyo3(from_py_with = arguments::seed)] seed: u64,
        precision: &str,
        period_s: Option<f64>,
        longest_s: f64,
    ) -> PyResult<Self> {
        let base = robot.map_or_else(BaseSpec::default, |robot| robot.file.base.clone());
        let (period_s, most) = (
            period_s.unwrap_or_else(|| base.period_s()),
            base.motion().max_tick_s,
        );
        if !(1.0e-4..=most).contains(&period_s) {
            let message = format!("period_s must be a number in 1e-4 to {most}");
            return Err(error::argument("period_s", &message));
        }
        check_length(longest_s, period_s)
            .map_err(|e| error::argument("longest_s", &format!("longest_s {e}")))?;
        let (precision, setup) = (
            self::precision(precision)?,
            self::world(&base, world, seed)?,
        );
        allowed(precision, setup.as_ref())?;
        let mission = Plan {
            name: "park".to_owned(),
            description: format!("park of a {}", base.name),
            robot: base.robot,
            precision,
            start: Measured {
                pose: pose("start", start)?,
                twist: Twist::default(),
            },
            course: Course::Park(pose("goal", goal)?),
            events: Vec::new(),
            period_s,
            end: End::Parked(longest_s),
            setup,
            base,
        };
        Ok(Self::of(Job::Mission {
            mission: Box::new(mission),
            file: None,
        }))
    }

    #[getter]
    fn name(&self) -> &str {
        self.job.name()
    }

    #[getter]
    fn description(&self) -> &str {
        match &*self.job {
            Job::Scenario(scenario) => &scenario.description,
            Job::Mission { mission, .. } => &mission.description,
        }
    }

    /// `neural`, `plain` or `motion`.
    #[getter]
    fn law(&self) -> &'static str {
        law(&self.job)
    }

    /// What a user should know before the robot finds out.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        texts(&of_job(&self.job))
    }

    fn __repr__(&self) -> String {
        format!("<twb.Mission {}: {}>", self.name(), self.description())
    }
}

/// The name of the law that drives.
pub fn law(job: &Job) -> &'static str {
    match job {
        Job::Mission { .. } => "motion",
        Job::Scenario(scenario) => match scenario.controller.kind {
            ControlLaw::Neural => "neural",
            ControlLaw::Plain => "plain",
        },
    }
}
