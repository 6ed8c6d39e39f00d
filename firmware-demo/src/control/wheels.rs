//! From an action to the driver.

use controller_core::base::WheelAction;
use controller_core::hal::{Error as _, WheelDrive};
use controller_core::types::WheelTorques;

use super::ControlTask;

impl<D: WheelDrive> ControlTask<'_, D> {
    /// Applies an output; after an error the wheels' state is unknown, and they are released.
    pub(super) fn apply(&mut self, action: &WheelAction<f32>, supply_v: Option<f32>) {
        let applied = match action {
            WheelAction::Drive(drive) => {
                self.drive.observe(&drive.observed(supply_v));
                self.drive.set_torques(drive.torques)
            }
            WheelAction::Brake => self.drive.brake(),
            WheelAction::Release => self.drive.release(),
        };
        self.output = *action;
        self.answer = applied.map_err(|error| error.kind());
        let exerted = if self.answer.is_err() {
            self.output = WheelAction::Release;
            if *action != WheelAction::Release {
                // If this fails too there is nothing left to do now; every tick from here on tries again.
                let _ = self.drive.release();
            }
            Some(WheelTorques::default())
        } else if action.torques().is_some() {
            self.drive.exerted()
        } else {
            None
        };
        if let Some(exerted) = exerted {
            // What is no number is not noted: the estimates go on with the commanded torques.
            let _ = self.controller.note_exerted(&exerted);
        }
    }
}
