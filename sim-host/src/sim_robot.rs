//! The plant behind the hardware traits: torques in, encoder counts and time out.

use crate::plant::Plant;
use controller_core::error::{Field, ParamError, Problem};
use controller_core::hal::{
    Clock, ErrorKind, ErrorType, WheelCounts, WheelDrive, WheelEncoders, accepts,
};
use controller_core::params::Robot;
use controller_core::types::{Measured, Twist, WheelTorques};
use std::cell::RefCell;
use std::f64::consts::TAU;
use std::rc::Rc;

/// What the simulated base has beside its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equipment {
    /// Largest torque of either wheel \[N m\], positive and finite.
    pub max_torque_nm: f32,
    /// Encoder counts per turn of a wheel, after gears and quadrature: 1 to 1e7.
    pub counts_per_turn: f64,
    /// Counts at the start.
    pub counts: WheelCounts,
    /// The clock at the start \[µs\].
    pub now_us: u32,
}

impl Default for Equipment {
    /// 10 N m, 4096 counts, everything at 0.
    fn default() -> Self {
        Self {
            max_torque_nm: 10.0,
            counts_per_turn: 4096.0,
            counts: WheelCounts::default(),
            now_us: 0,
        }
    }
}

/// A simulated base as a control task sees it.
///
/// A handle: clones share one robot, so a task can own drive, encoders and clock while the
/// simulation keeps a fourth clone to let time pass. Nothing moves but in
/// [`advance`](Self::advance), so a run gives the same numbers every time.
#[derive(Clone, Debug)]
pub struct SimRobot(Rc<RefCell<State>>);

#[derive(Debug)]
struct State {
    plant: Plant,
    robot: Robot<f64>,
    equipment: Equipment,
    torques: WheelTorques<f32>,
    /// Turns of the right and the left wheel since the start.
    turns: [f64; 2],
    now_us: u32,
}

impl SimRobot {
    /// A robot at `start` with released wheels.
    ///
    /// # Errors
    /// Equipment out of its range.
    pub fn new(
        robot: Robot<f64>,
        start: &Measured<f64>,
        equipment: Equipment,
    ) -> Result<Self, ParamError> {
        within(
            Field::MaxWheelTorque,
            f64::from(equipment.max_torque_nm),
            1.0e-6,
            1.0e6,
        )?;
        within(Field::CountsPerTurn, equipment.counts_per_turn, 1.0, 1.0e7)?;
        Ok(Self(Rc::new(RefCell::new(State {
            plant: Plant::new(robot, start),
            robot,
            equipment,
            torques: WheelTorques::default(),
            turns: [0.0; 2],
            now_us: equipment.now_us,
        }))))
    }

    /// Lets time pass with the torques held.
    pub fn advance(&self, us: u32) {
        self.0.borrow_mut().advance(us);
    }

    /// The robot as it truly is, which no encoder says.
    pub fn truth(&self) -> Measured<f64> {
        self.0.borrow().plant.truth()
    }

    /// The torques that act.
    pub fn torques(&self) -> WheelTorques<f32> {
        self.0.borrow().torques
    }
}

impl State {
    fn advance(&mut self, us: u32) {
        let dt = 1.0e-6 * f64::from(us);
        let torques = WheelTorques {
            right: f64::from(self.torques.right),
            left: f64::from(self.torques.left),
        };
        let before = self.plant.truth().twist;
        self.plant.advance(&torques, dt);
        let after = self.plant.truth().twist;
        // Under held torques speeds are linear in time, so their mean is exact.
        let mean = Twist::new(
            0.5 * (before.linear + after.linear),
            0.5 * (before.angular + after.angular),
        );
        let wheels = &self.robot.wheels;
        let sideways = 0.5 * wheels.track_m * mean.angular;
        let [right, left] = &mut self.turns;
        *right += dt * (mean.linear + sideways) / (TAU * wheels.radius_right_m);
        *left += dt * (mean.linear - sideways) / (TAU * wheels.radius_left_m);
        self.now_us = self.now_us.wrapping_add(us);
    }

    fn counts(&self) -> WheelCounts {
        let Equipment {
            counts_per_turn,
            counts,
            ..
        } = self.equipment;
        // An encoder counts the edges that it has passed; the low 32 bits of them are its counter.
        let wrapped = |turns: f64| (turns * counts_per_turn).floor() as i64 as i32;
        let [right, left] = self.turns;
        WheelCounts {
            right: counts.right.wrapping_add(wrapped(right)),
            left: counts.left.wrapping_add(wrapped(left)),
        }
    }
}

impl ErrorType for SimRobot {
    type Error = ErrorKind;
}

impl WheelDrive for SimRobot {
    fn max_torque_nm(&self) -> f32 {
        self.0.borrow().equipment.max_torque_nm
    }

    fn set_torques(&mut self, torques: WheelTorques<f32>) -> Result<(), ErrorKind> {
        let state = &mut *self.0.borrow_mut();
        if !accepts(&torques, state.equipment.max_torque_nm) {
            return Err(ErrorKind::OutOfRange);
        }
        state.torques = torques;
        Ok(())
    }

    fn release(&mut self) -> Result<(), ErrorKind> {
        self.0.borrow_mut().torques = WheelTorques::default();
        Ok(())
    }
}

impl WheelEncoders for SimRobot {
    fn counts(&mut self) -> Result<WheelCounts, ErrorKind> {
        Ok(self.0.borrow().counts())
    }
}

impl Clock for SimRobot {
    fn now_us(&self) -> u32 {
        self.0.borrow().now_us
    }
}

fn within(field: Field, value: f64, low: f64, high: f64) -> Result<(), ParamError> {
    let problem = if !value.is_finite() {
        Problem::NotFinite
    } else if value < low {
        Problem::Below(low)
    } else if value > high {
        Problem::Above(high)
    } else {
        return Ok(());
    };
    Err(ParamError { field, problem })
}
