//! A realistic plant: the truth that the controller's models are tested against.
//!
//! Written from the equations of motion, electricity and friction with nothing of the controller's
//! motor, odometry or fusion models in it. With the defaults of [`WorldKeys`] it is the perfect
//! robot of [`crate::plant`]; every imperfection is a key of its own.
//!
//! | part | holds | module |
//! | --- | --- | --- |
//! | body | off-centre mass, Coriolis terms, slope, pushes | `plant`, `floor` |
//! | wheels | stiction, Coulomb, viscous and rolling friction; grip on a friction circle, slip, skid | `contact`, `slide`, `tyre` |
//! | drives | battery sag, dead band, current limit, winding, gear losses | `electric` |
//! | senses | encoders, late and noisy poses, voltage, currents, uneven ticks | `senses` |
//! | gyro | noise, bias and its walk, scale, range, rounding, age | `gyro` |
//! | faults | put in and taken out while it runs | [`PlantFault`] |
//!
//! Everything follows from parameters, start, seed and commands: the same bits on any machine and
//! any thread. Each source of noise has its own stream of random numbers.
//!
//! ```
//! use controller_core::robot::Robot;
//! use controller_core::types::Measured;
//! use sim_host::world::{Actuation, World, presets};
//!
//! let params = presets::paper_30kg().params(&Robot::paper());
//! let mut world = World::new(&params, &Measured::default(), 7)?;
//! let full = Actuation::Duty { right: 0.5, left: 0.5 };
//! for _ in 0..100 {
//!     let dt_us = world.next_tick_us(10_000);
//!     world.advance(&full, dt_us)?;
//! }
//! assert!(world.truth().twist.linear > 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod actuation;
mod check;
mod contact;
mod electric;
mod error;
mod facing;
mod floor;
mod gyro;
mod handle;
mod keys;
mod pair;
mod params;
mod plant;
mod plant_fault;
pub mod presets;
mod random;
mod sense_params;
mod senses;
mod slide;
mod speed_loop;
mod substep;
mod tyre;

pub use actuation::{Actuation, Side};
pub use error::{ActuationError, WorldError};
pub use gyro::GyroSample;
pub use handle::{LONGEST_TICK_US, World};
pub use keys::{BodyKeys, WorldKeys, WorldSetup};
pub use params::{
    BatteryParams, BodyParams, FloorParams, FrictionParams, GRAVITY, LEAST_LOOP_S, MotorParams,
    PatchParams, PushParams, SPEED_LOOP_S, SUBSTEP_US, WorldParams,
};
pub use plant_fault::PlantFault;
pub use sense_params::{EncoderParams, GyroParams, NoiseParams, PoseSourceParams, TickParams};
