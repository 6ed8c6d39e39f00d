//! The fault campaign: every state of the supervisor, every kind of trouble, at random times, by the thousand.
//!
//! A [`Plan`] is drawn from a seed and the number of a run: base, true plant, course, the state in which the
//! trouble strikes, the trouble and when it heals, and what the host does afterwards. [`fn@run`] drives the firmware's
//! [`Board`](crate::closed_loop::Board) through it, by frames over a line that may be full, damaged and late, and checks every
//! tick:
//!
//! | always | |
//! | --- | --- |
//! | stop | one that arrived is obeyed in the next tick, from every state |
//! | outputs | torques within their limit, duties within ±1, all numbers finite, no torque where nothing drives |
//! | order | no stop becomes milder, and none that latched is left, before the host says so |
//! | reaction | what is found in a live base has at least its reaction in the same tick |
//! | name | a base is stopped for what is there, by its one name ([`RULES`]); before the trouble for nothing |
//! | time | what has to be found is found within its deadline |
//! | way | from the tick in which a stop begins to rest it is within its bound |
//! | parked | the true pose is at the goal, and of a base that gets no poses its own |
//! | end | the base parks, waits as it was, or rests in Stopped or Fault |
//!
//! Runs end without a trace kept; [`study`] runs them side by side.

mod bounds;
mod check;
mod expected;
mod fault_injection;
mod host;
mod line;
mod outcome;
mod path;
mod plan;
mod random;
mod report;
mod robots;
mod run;
mod study;
mod summary;

pub use expected::{Clock, GYRO_ALSO, GYRO_RULES, KNOWN, Known, RULES, Rule, known};
pub use fault_injection::{FaultInjection, FaultInjectionKind};
pub use outcome::{Detection, End, Failing, RunOutcome, Stop, Violation, Why};
pub use plan::{Bases, Plan, Target};
pub use report::{Record, TraceWriter, run_sheet, table, tick_fields, violation, write_runs};
pub use robots::{GyroOfRobot, Robots};
pub use run::{Mutation, Tick, run};
pub use study::{Campaign, CampaignError, MAX_FIRST, MAX_RUNS, NoTrouble, study};
pub use summary::{Cell, CellRecord, cells};
