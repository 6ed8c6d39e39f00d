//! Which state the base is in, and what brings it into another.
//!
//! [`next`] is a pure table over states and events, without time and hardware. [`Supervisor`] adds what a
//! tick needs beside it: the cause, the fault that is latched, the limit on the time of a stop.
//!
//! * Torque flows in Tracking, Parking and Stopping, and in Parked where the base holds its goal.
//! * An emergency stop, and a fault that brakes or releases, lead from every state in one step to one
//!   without torque.
//! * Out of Fault leads nothing but a reset, and it leads to Idle; nothing moves by a reset or by arming.
//! * No fault leads to a milder output than is in force: release, then brake, then controlled stop.
//! * What was braked or released stays so until the base is armed or reset: on a slope nothing that was stopped in haste rolls away.
//!   An emergency stop brakes what is at rest as well, for it may be rolling, but not what a reaction released.
//!
//! A driver without an electrical brake does for [`OutputMode::Brake`] what it can, which is to release. A
//! host whose stop is to let go at once sends `Event::Fault(Response::passing(Reaction::Release))`.

mod params;
mod run;
mod state;
mod table;

pub use params::{Emergency, IdleOutput, RestLimits, SupervisorParams, ValidSupervisorParams};
pub use run::{Cause, Supervisor};
pub use state::{Action, Event, OutputMode, State, Then};
pub use table::next;

#[cfg(test)]
mod tests;
