//! Whole bases on the realistic plant, driven by velocity, side by side.

use crate::mission::{pose, world};
use crate::robot::Robot;
use crate::{arguments, error, sheet};
use controller_core::base::Order;
use controller_core::queue::ReferenceQueue;
use controller_core::safety::supervisor::State;
use controller_core::types::{Measured, Pose, Twist};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use protocol::Command;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use self_cell::{MutBorrow, self_cell};
use sim_host::closed_loop::{ClosedLoop, ClosedLoopError};
use sim_host::job::RobotFile;
use sim_host::mission::{Course, End, Mission};
use sim_host::precision::Precision;
use sim_host::trace::state_name;
use std::sync::{Arc, Mutex, PoisonError};

type Queue = ReferenceQueue<f32, 2>;

self_cell!(
    /// A closed loop, and the queue that it borrows its end of.
    struct Member {
        owner: MutBorrow<Queue>,
        #[not_covariant]
        dependent: ClosedLoop,
    }
);

impl Member {
    /// A base that knows where it is and is armed.
    fn start(robot: &RobotFile, name: &str, start: Pose<f64>, seed: u64) -> PyResult<Self> {
        let base = &robot.base;
        let mission = Mission {
            name: robot.name.clone(),
            description: String::new(),
            robot: base.robot,
            precision: Precision::F32,
            start: Measured {
                pose: start,
                twist: Twist::default(),
            },
            course: Course::Drive,
            events: Vec::new(),
            period_s: base.period_s(),
            end: End::At(f64::INFINITY),
            setup: world(base, Some(name), seed)?,
            base: base.clone(),
        };
        let failed = |e: ClosedLoopError| error::run(&e.to_string());
        let setup = mission.setup.clone();
        let setup = setup.ok_or_else(|| error::argument("world", "a fleet needs a world"))?;
        let mut member = Self::try_new(MutBorrow::new(Queue::new()), |queue| {
            ClosedLoop::new(queue.borrow_mut().split().1, &mission, &setup, None)
        })
        .map_err(failed)?;
        for _ in 0..ARMING_TICKS {
            member.tick(Twist::default()).map_err(failed)?;
            if member.with_dependent(|_, one| one.report().state != State::Idle) {
                return Ok(member);
            }
        }
        Err(error::run("the base cannot be armed"))
    }

    /// One tick under a velocity order; an idle base that knows where it is is armed first.
    fn tick(&mut self, twist: Twist<f32>) -> Result<(), ClosedLoopError> {
        self.with_dependent_mut(|_, one| {
            one.advance()?;
            let order = match one.report().state {
                State::Idle if one.report().measured.is_some() => {
                    // An idle base that knows where it is refuses no arming.
                    let _ = one.command(&Command::Arm)?;
                    Order::None
                }
                State::Idle => Order::None,
                _ => Order::Drive {
                    twist,
                    hold_heading: false,
                },
            };
            one.tick(&order)?;
            Ok(())
        })
    }

    fn observed(&self) -> Observed {
        self.with_dependent(|_, one| {
            let believed = one.report().measured.unwrap_or_default();
            Observed {
                believed: row(&believed.cast()),
                truth: row(&one.world().truth()),
                time_s: 1.0e-6 * one.world().now_us() as f64,
                state: state_name(one.report().state),
            }
        })
    }
}

/// A base knows where it is after its first tick, is armed in the next, and says so in the one after.
const ARMING_TICKS: usize = 10;

/// What is seen of a member.
struct Observed {
    believed: [f64; 5],
    truth: [f64; 5],
    time_s: f64,
    state: &'static str,
}

fn row(measured: &Measured<f64>) -> [f64; 5] {
    let Measured { pose, twist } = measured;
    [pose.x, pose.y, pose.theta, twist.linear, twist.angular]
}

/// Bases in worlds of their own: the firmware's control task with localiser, supervisor and motors, driven by velocity.
#[pyclass(module = "twb", frozen)]
pub struct Fleet {
    robot: Arc<RobotFile>,
    world: String,
    members: Mutex<Vec<Option<Member>>>,
    pool: Option<ThreadPool>,
}

#[pymethods]
impl Fleet {
    /// So many bases of a robot, in no world yet.
    #[new]
    #[pyo3(signature = (robot, size, world = "drawn", threads = None))]
    fn new(
        robot: &Robot,
        #[pyo3(from_py_with = arguments::size)] size: usize,
        world: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<usize>,
    ) -> PyResult<Self> {
        self::world(&robot.file.base, Some(world), 0)?;
        let pool = match (size, threads) {
            (0 | 1, _) | (_, Some(1)) => None,
            (_, threads) => {
                let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
                let pool = pool.build();
                Some(pool.map_err(|e| error::run(&format!("no threads: {e}")))?)
            }
        };
        Ok(Self {
            robot: Arc::clone(&robot.file),
            world: world.to_owned(),
            members: Mutex::new((0..size).map(|_| None).collect()),
            pool,
        })
    }

    fn __len__(&self) -> usize {
        self.members().len()
    }

    /// Puts the members of `which` into new worlds, at rest at `starts` (x, y, theta).
    fn reset(
        &self,
        py: Python<'_>,
        which: PyReadonlyArray1<'_, i64>,
        starts: PyReadonlyArray2<'_, f64>,
        seeds: PyReadonlyArray1<'_, u64>,
    ) -> PyResult<()> {
        let (which, starts, seeds) = (which.as_array(), starts.as_array(), seeds.as_array());
        let size = self.members().len();
        if starts.dim() != (which.len(), 3) || seeds.len() != which.len() {
            let message = format!("starts must be {} by 3, with as many seeds", which.len());
            return Err(error::argument("starts", &message));
        }
        let mut chosen = Vec::new();
        for ((index, start), seed) in which.iter().zip(starts.outer_iter()).zip(seeds) {
            let index = usize::try_from(*index).ok().filter(|index| *index < size);
            let index = index.ok_or_else(|| {
                let message = format!("which must have numbers from 0 to {}", size.max(1) - 1);
                error::argument("which", &message)
            })?;
            let start = pose("starts", [start[0], start[1], start[2]])?;
            chosen.push((index, start, *seed));
        }
        let started = py.detach(|| {
            let start = |(index, start, seed): &(usize, Pose<f64>, u64)| {
                let member = Member::start(&self.robot, &self.world, *start, *seed)?;
                Ok((*index, member))
            };
            match &self.pool {
                Some(pool) => pool.install(|| chosen.par_iter().map(start).collect()),
                None => chosen.iter().map(start).collect::<PyResult<Vec<_>>>(),
            }
        })?;
        let mut members = self.members();
        for (index, member) in started {
            members[index] = Some(member);
        }
        Ok(())
    }

    /// Lets every member drive with its own row of `twists` (v, w) for so many ticks. Those that are in no world stay so.
    fn step(
        &self,
        py: Python<'_>,
        twists: PyReadonlyArray2<'_, f64>,
        #[pyo3(from_py_with = arguments::ticks)] ticks: usize,
    ) -> PyResult<()> {
        let twists = twists.as_array();
        let size = self.members().len();
        if twists.dim() != (size, 2) {
            let message = format!("twists must be {size} by 2");
            return Err(error::argument("twists", &message));
        }
        let rows = twists.outer_iter();
        let twists: Vec<_> = rows
            .map(|row| Twist::new(row[0] as f32, row[1] as f32))
            .collect();
        py.detach(|| {
            let members = &mut *self.members();
            let drive = |(member, twist): (&mut Option<Member>, &Twist<f32>)| {
                let Some(member) = member else { return Ok(()) };
                (0..ticks).try_for_each(|_| member.tick(*twist))
            };
            let driven = match &self.pool {
                Some(pool) => pool.install(|| {
                    let members = members.par_iter_mut().zip(&twists);
                    members.map(drive).collect()
                }),
                None => (members.iter_mut().zip(&twists))
                    .map(drive)
                    .collect::<Vec<Result<(), ClosedLoopError>>>(),
            };
            let all: Result<(), ClosedLoopError> = driven.into_iter().collect();
            all.map_err(|e| error::run(&e.to_string()))
        })
    }

    /// For each member a row (x, y, theta, v, w) as the base believes it, `believed`, and as it is, `truth`; the time in
    /// its world, `time_s`; the supervisor's `state`. Not a number, and no state, where there is no world yet.
    fn observe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let seen: Vec<Option<Observed>> = {
            let members = self.members();
            let seen = members.iter();
            seen.map(|member| member.as_ref().map(Member::observed))
                .collect()
        };
        let table = |row: fn(&Observed) -> [f64; 5]| -> PyResult<_> {
            let rows = seen.iter();
            let numbers = rows.flat_map(|one| one.as_ref().map_or([f64::NAN; 5], row));
            let array: Bound<'py, PyArray1<f64>> =
                PyArray1::from_vec(py, numbers.collect::<Vec<_>>());
            let array: Bound<'py, PyArray2<f64>> = array.reshape([seen.len(), 5])?;
            Ok(array)
        };
        let dict = PyDict::new(py);
        dict.set_item("believed", table(|one| one.believed)?)?;
        dict.set_item("truth", table(|one| one.truth)?)?;
        let times = seen.iter();
        let times = times.map(|one| one.as_ref().map_or(f64::NAN, |one| one.time_s));
        dict.set_item("time_s", PyArray1::from_iter(py, times))?;
        let states = seen.iter();
        let states = states.map(|one| one.as_ref().map_or("", |one| one.state).to_owned());
        dict.set_item("state", sheet::words(py, states)?)?;
        Ok(dict)
    }
}

impl Fleet {
    /// A panic in a member is reported by the call that it happened in.
    fn members(&self) -> std::sync::MutexGuard<'_, Vec<Option<Member>>> {
        self.members.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
