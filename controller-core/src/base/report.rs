//! Everything that a tick of a base computed.

use super::io::WheelAction;
use crate::gyro::GyroReport;
use crate::localiser::FixOutcome;
use crate::motion::MotionReport;
use crate::motor::SpeedLimited;
use crate::odometry::drift_angle;
use crate::safety::ActiveFaults;
use crate::safety::supervisor::{Cause, State};
use crate::scalar::Scalar;
use crate::types::Measured;

/// The report of one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseReport<T = f32> {
    /// What the wheels are to do.
    pub action: WheelAction<T>,
    /// The supervisor's state after this tick.
    pub state: State,
    /// Why it is that.
    pub cause: Cause,
    /// Pose and twist; `None` before the encoders gave a first reading.
    pub measured: Option<Measured<T>>,
    /// They are extrapolated: the encoders gave nothing in this tick, or counts that no wheel can have come to.
    pub blind: bool,
    /// Turn that odometry adds per way, as external poses taught it \[rad/m\]: wheels of other radii than stated. See
    /// [`Estimate::curvature_bias`](crate::localiser::Estimate::curvature_bias).
    pub curvature_bias: T,
    /// Turn that odometry adds per turn, as external poses taught it: wheels that are not as far apart as stated. See
    /// [`Estimate::turn_bias`](crate::localiser::Estimate::turn_bias).
    pub turn_bias: T,
    /// What the tyres slip per acceleration, as external poses taught it \[s²/m\]. See
    /// [`Estimate::tyre_slip`](crate::localiser::Estimate::tyre_slip).
    pub tyre_slip: T,
    /// By what share the motor constant of the right wheel is above what is stated, and that of the left one below it: motors that are not
    /// alike. Learnt while torque flows, within ± 0.1; 0 of a base without motors.
    pub motor_bias: T,
    /// What limited the speeds that drivers with their own speed loop are to hold; nothing of a base without such.
    pub speed_limited: SpeedLimited,
    /// What became of an external pose.
    pub fix: FixOutcome<T>,
    /// What is known of the gyro, where there is one.
    pub gyro: GyroReport<T>,
    /// Faults found in this tick, ignored or not.
    pub active_faults: ActiveFaults,
    /// The order does not fit the state; nothing came of it.
    pub refused: bool,
    /// The motion law's report, while its torque flows.
    pub motion: Option<MotionReport<T>>,
}

impl<T: Scalar> BaseReport<T> {
    /// Before the first tick.
    pub(super) fn new(state: State, cause: Cause) -> Self {
        Self {
            action: WheelAction::Release,
            state,
            cause,
            measured: None,
            blind: false,
            curvature_bias: T::ZERO,
            turn_bias: T::ZERO,
            tyre_slip: T::ZERO,
            motor_bias: T::ZERO,
            speed_limited: SpeedLimited::default(),
            fix: FixOutcome::Absent,
            gyro: GyroReport::default(),
            active_faults: ActiveFaults::NONE,
            refused: false,
            motion: None,
        }
    }

    /// What is measured, for a law that reckons with a base that moves where it heads: its course in place of its heading, since tyres slip aside.
    pub(super) fn course(&self) -> Option<Measured<T>> {
        self.measured.map(|mut measured| {
            measured.pose.theta += drift_angle(self.tyre_slip, &measured.twist);
            measured
        })
    }
}
