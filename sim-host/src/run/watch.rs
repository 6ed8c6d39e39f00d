//! Runs that somebody watches while they go on.

use crate::csv_out::Line;
use crate::world::World;
use controller_core::types::{Measured, WheelSpeeds};
use std::f64::consts::TAU;

/// Who sees every tick of a run as it comes; nobody, usually.
pub type Watch<'w> = Option<&'w mut dyn FnMut(&Seen<'_>)>;

/// A tick, and what is known of it beside its row.
pub struct Seen<'a> {
    /// The row. Where a run hands over several times, each of them is marked.
    pub line: Line<'a>,
    /// Pose and twist that the controller got.
    pub measured: Measured<f64>,
    /// Of a plant that has wheels with encoders, if these gave something.
    pub wheels: Option<WheelStates>,
}

/// Wheels at the beginning of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelStates {
    /// Angles as the encoders have them, right before left \[rad\].
    pub angles: [f64; 2],
    /// As they truly turn.
    pub speeds: WheelSpeeds<f64>,
}

impl WheelStates {
    /// None where an encoder gave nothing.
    pub fn of(world: &World) -> Option<Self> {
        let counts = world.counts().ok()?;
        let step = TAU / world.counts_per_turn();
        Some(Self {
            angles: [counts.right, counts.left].map(|count| step * f64::from(count)),
            speeds: world.wheel_speeds(),
        })
    }
}
