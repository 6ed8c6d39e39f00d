//! Both wheels of a base at once.

use super::command::{MotorCommand, WheelDemand};
use super::params::Motor;
use crate::hal::Observed;
use crate::types::WheelTorques;

/// What both motors are driven with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelCommands {
    /// Right wheel.
    pub right: MotorCommand<f32>,
    /// Left wheel.
    pub left: MotorCommand<f32>,
}

impl Motor<f32> {
    /// [`command`](Self::command) of both wheels, for a driver of the hardware traits.
    #[inline]
    pub fn commands(&self, torques: &WheelTorques<f32>, observed: &Observed) -> WheelCommands {
        let Observed {
            speeds,
            desired,
            beyond_coulomb,
            supply_v,
        } = observed;
        let supply = self.believed(*supply_v);
        let right = WheelDemand {
            torque_nm: torques.right,
            desired_speed_rad_s: desired.right,
            speed_rad_s: speeds.right,
            beyond_coulomb_nm: beyond_coulomb.map(|beyond| beyond.right),
        };
        let left = WheelDemand {
            torque_nm: torques.left,
            desired_speed_rad_s: desired.left,
            speed_rad_s: speeds.left,
            beyond_coulomb_nm: beyond_coulomb.map(|beyond| beyond.left),
        };
        // Where one is limited both are worked out anew, so that without limits nothing has to be kept of what was limited.
        let unlimited = |demand| self.unlimited_command(demand, supply);
        if let Some(right) = unlimited(&right)
            && let Some(left) = unlimited(&left)
        {
            return WheelCommands { right, left };
        }
        self.limited_commands(&(right, left), supply)
    }

    #[cold]
    #[inline(never)]
    fn limited_commands(
        &self,
        (right, left): &(WheelDemand<f32>, WheelDemand<f32>),
        supply: (f32, bool),
    ) -> WheelCommands {
        WheelCommands {
            right: self.limited_command(right, supply),
            left: self.limited_command(left, supply),
        }
    }
}

impl WheelCommands {
    /// What the wheels exert beyond their friction \[N m\], where current or supply limited a torque; `None` where
    /// it is what was asked.
    pub fn exerted(&self) -> Option<WheelTorques<f32>> {
        let Self { right, left } = self;
        let limited = right.limited.torque() | left.limited.torque();
        limited.then_some(WheelTorques {
            right: right.torque_nm - right.friction_nm,
            left: left.torque_nm - left.friction_nm,
        })
    }

    /// A speed was not a number: there is no duty for it.
    pub const fn is_invalid(&self) -> bool {
        self.right.limited.invalid || self.left.limited.invalid
    }
}
