//! What can go wrong, how it is found, what is done about it, and how far the base goes until it stands.
//!
//! ```text
//! DetectorInputs -> Monitor::check -> ActiveFaults -> Supervisor::on_active_faults (Policy) -> OutputMode
//! commands, mission ---------> Event ----> Supervisor::on ------^                   |
//!                                          Supervisor::tick (time, at rest)     StopPlan
//! ```
//!
//! | part | what it is |
//! | --- | --- |
//! | [`Fault`], [`FaultKind`] | what went wrong, typed, with a stable code |
//! | [`Reaction`], [`Response`], [`ValidPolicyParams`] | what is done about each kind, checked against what it leaves working |
//! | [`DetectorParams`], [`Timeout`] | thresholds and times; off only where it says so |
//! | [`Silence`] | how long something has not been seen |
//! | [`Monitor`] | detectors: one call a tick, plain values in, [`ActiveFaults`] out |
//! | [`supervisor`] | states and events: a table without a wildcard |
//! | [`StopPlan`], [`controlled_stop`] | the controlled stop and the way it takes |
//!
//! Nothing here has a clock or touches hardware: time comes as microseconds since the last tick.

mod detector_params;
mod fault;
mod inputs;
mod monitor;
mod policy;
mod reaction;
mod silence;
mod stopping;
pub mod supervisor;

pub use detector_params::{
    CurrentDetectorParams, DetectorParams, SlipDetectorParams, StuckDetectorParams,
    SupplyDetectorParams, TickDetectorParams, Timeout, ValidDetectorParams, WheelDetectorParams,
};
pub(crate) use detector_params::{LEAST_STUCK_TORQUE_NM, LOADS, SLOW, UNNOTICED};
pub use fault::{Fault, FaultKind, PolicyParams, Side};
pub use inputs::{ActiveFaults, Currents, DetectorInputs};
pub(crate) use monitor::Detectors;
pub use monitor::{LOOK_US, Monitor};
pub use policy::{PolicyError, PolicyProblem, ValidPolicyParams};
pub use reaction::{Reaction, Response};
pub use silence::Silence;
pub use stopping::{StopPlan, Stopping, controlled_stop, controlled_stop_distance};
pub use supervisor::{OutputMode, Supervisor};
