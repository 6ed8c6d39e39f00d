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
        let command = |torque_nm, desired_speed_rad_s, speed_rad_s, beyond_coulomb_nm| {
            let demand = WheelDemand {
                torque_nm,
                desired_speed_rad_s,
                speed_rad_s,
                beyond_coulomb_nm,
            };
            self.command_from(&demand, supply)
        };
        WheelCommands {
            right: command(
                torques.right,
                desired.right,
                speeds.right,
                beyond_coulomb.map(|beyond| beyond.right),
            ),
            left: command(
                torques.left,
                desired.left,
                speeds.left,
                beyond_coulomb.map(|beyond| beyond.left),
            ),
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
