//! Parameters into force.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

use controller_core::base::{BaseError, BaseParams, ValidBaseParams};
use controller_core::hal::WheelDrive;
use controller_core::safety::supervisor::State;

use super::ControlTask;
use protocol::FieldParams;

/// Why parameters are none for this robot.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SettingError {
    /// The core refuses them.
    Base(BaseError),
    /// The wheel torque is above what the wheel driver can do.
    TorqueLimit,
}

impl Display for SettingError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Base(error) => error.fmt(f),
            Self::TorqueLimit => f.write_str("wheel_torque is above that of the driver"),
        }
    }
}

impl Error for SettingError {}

/// Why parameters are not changed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SetError {
    /// The base is neither in Idle nor in Stopped.
    Armed,
    /// They are none for this robot.
    Setting(SettingError),
}

/// The controller limits torques by itself, to know when it does; so its limit has to be one that the driver takes.
pub(super) fn check<D: WheelDrive>(
    params: &BaseParams<f32>,
    drive: &D,
) -> Result<ValidBaseParams<f32>, SettingError> {
    // Not taken apart and put together again: that would be a second copy on the stack.
    let base = params.validate().map_err(SettingError::Base);
    if base.is_ok() && params.motion.limits.wheel_torque_nm > drive.max_torque_nm() {
        return Err(SettingError::TorqueLimit);
    }
    base
}

impl<D: WheelDrive> ControlTask<'_, D> {
    /// Takes what the host, or the flash, has to say about the parameters; the rest is as compiled.
    ///
    /// # Errors
    ///
    /// [`SetError`]; everything is as it was then.
    pub fn set_field(&mut self, field: &FieldParams) -> Result<(), SetError> {
        let params = field.apply(&self.defaults);
        self.set_params(&params)
    }

    /// Goes back to the parameters that the firmware was compiled with.
    ///
    /// # Errors
    ///
    /// [`SetError::Armed`].
    pub fn load_defaults(&mut self) -> Result<(), SetError> {
        let params = self.defaults;
        self.set_params(&params)
    }

    /// Whether parameters may be changed or stored now.
    pub const fn is_disarmed(&self) -> bool {
        matches!(self.state(), State::Idle | State::Stopped)
    }

    fn set_params(&mut self, params: &BaseParams<f32>) -> Result<(), SetError> {
        if !self.is_disarmed() {
            return Err(SetError::Armed);
        }
        let checked = check(params, &self.drive);
        // By reference: out of its result it would be another copy on the stack.
        let base = checked
            .as_ref()
            .map_err(|error| SetError::Setting(*error))?;
        self.controller
            .reconfigure(base)
            .map_err(|_| SetError::Armed)?;
        self.params = *params;
        Ok(())
    }
}
