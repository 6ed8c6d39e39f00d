//! Something in the loop that is broken on purpose.

use crate::closed_loop::Board;
use crate::world::Actuation;
use controller_core::base::WheelAction;
use controller_core::safety::PolicyParams;

/// Something in the loop that is broken on purpose, to see that the campaign finds it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Mutation {
    /// Nothing.
    #[default]
    None,
    /// The driver goes on with the last torque when it should release or brake.
    KeepsTorque,
    /// The brake is not connected: wheels coast.
    BrakeCoasts,
    /// Stops that have arrived are thrown away.
    LosesStops,
    /// Another policy.
    Policy(PolicyParams),
}

/// A driver with a mutation: what the wheels get in place of what the base put out.
pub(super) struct BrokenDriver {
    pub(super) mutation: Mutation,
    /// The last that drove.
    torque: Actuation,
}

impl BrokenDriver {
    pub(super) const fn new(mutation: Mutation) -> Self {
        Self {
            mutation,
            torque: Actuation::Release,
        }
    }

    pub(super) fn act(&mut self, board: &mut Board<'_>, action: &WheelAction<f32>) {
        match (self.mutation, action) {
            (_, WheelAction::Drive(_)) => self.torque = *board.actuation(),
            (Mutation::KeepsTorque, _) => board.override_actuation(self.torque),
            (Mutation::BrakeCoasts, WheelAction::Brake) => {
                board.override_actuation(Actuation::Release);
            }
            _ => {}
        }
    }
}
