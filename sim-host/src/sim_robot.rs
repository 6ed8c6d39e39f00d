//! The plant behind the hardware traits: torques in, encoder counts and time out.

use crate::plant::Plant;
use controller_core::error::{Field, ParamError, Problem};
use controller_core::hal::{
    Clock, ErrorKind, ErrorType, WheelCounts, WheelDrive, WheelEncoders, accepts,
};
use controller_core::maths::{Libm, Maths};
use controller_core::robot::Robot;
use controller_core::types::{Measured, Twist, WheelTorques};
use std::cell::RefCell;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Braking torques change with the speed; between changes they are held for so long \[µs\], as long as the
/// plant's own substep.
const BRAKE_STEP_US: u32 = 250;

/// What the simulated base has beside its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equipment {
    /// Largest torque of either wheel \[N m\], positive and finite.
    pub max_torque_nm: f32,
    /// Torque of a braked wheel per speed \[N m s/rad\], 1e-6 to 1e6: (g k_t)²/R of its shorted motor.
    pub brake_nm_s: f64,
    /// Encoder counts per turn of a wheel, after gears and quadrature: 1 to 1e7.
    pub counts_per_turn: f64,
    /// Counts at the start.
    pub counts: WheelCounts,
    /// The clock at the start \[µs\].
    pub now_us: u32,
}

impl Default for Equipment {
    /// 10 N m, 1 N m s of brake, 4096 counts, everything at 0.
    fn default() -> Self {
        Self {
            max_torque_nm: 10.0,
            brake_nm_s: 1.0,
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
    /// Both motors are shorted; no other torque acts then.
    braked: bool,
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
        within(Field::BrakeDamping, equipment.brake_nm_s, 1.0e-6, 1.0e6)?;
        within(Field::CountsPerTurn, equipment.counts_per_turn, 1.0, 1.0e7)?;
        Ok(Self(Rc::new(RefCell::new(State {
            plant: Plant::new(robot, start),
            robot,
            equipment,
            torques: WheelTorques::default(),
            braked: false,
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

    /// Both wheels are braked.
    pub fn braked(&self) -> bool {
        self.0.borrow().braked
    }

    /// The torques that were told and act; zero for wheels that are released or braked.
    pub fn torques(&self) -> WheelTorques<f32> {
        self.0.borrow().torques
    }
}

impl State {
    fn advance(&mut self, us: u32) {
        if self.braked {
            let mut left = us;
            while left > 0 {
                let step = left.min(BRAKE_STEP_US);
                let dt = 1.0e-6 * f64::from(step);
                let torques = self.brake_torques(dt);
                self.roll(&torques, dt);
                left -= step;
            }
        } else {
            let torques = WheelTorques {
                right: f64::from(self.torques.right),
                left: f64::from(self.torques.left),
            };
            self.roll(&torques, 1.0e-6 * f64::from(us));
        }
        self.now_us = self.now_us.wrapping_add(us);
    }

    /// The torques that, held for `dt`, change both speeds as shorted motors do, each like exp(−t/T) with
    ///
    /// ```text
    /// 1/T_v = κ s/m      1/T_w = κ s (l/2)²/I      s = 1/r_R² + 1/r_L²
    /// ```
    ///
    /// exact at the end of `dt` for any stiffness. What unequal wheels couple is left out.
    fn brake_torques(&self, dt: f64) -> WheelTorques<f64> {
        let Robot {
            mass_kg,
            inertia_kg_m2,
            wheels,
        } = &self.robot;
        let (right, left) = (wheels.radius_right_m, wheels.radius_left_m);
        let arm = 0.5 * wheels.track_m;
        let damping = self.equipment.brake_nm_s * (right.powi(-2) + left.powi(-2));
        let fading = |speed: f64, rate: f64| speed * Libm::exp_m1(-rate * dt) / dt;
        let twist = self.plant.truth().twist;
        let force = mass_kg * fading(twist.linear, damping / mass_kg);
        let turning = damping * arm * arm / inertia_kg_m2;
        let moment = inertia_kg_m2 * fading(twist.angular, turning);
        WheelTorques {
            right: right * 0.5 * (force + moment / arm),
            left: left * 0.5 * (force - moment / arm),
        }
    }

    fn roll(&mut self, torques: &WheelTorques<f64>, dt: f64) {
        let before = self.plant.truth().twist;
        self.plant.advance(torques, dt);
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
        state.braked = false;
        Ok(())
    }

    fn release(&mut self) -> Result<(), ErrorKind> {
        let state = &mut *self.0.borrow_mut();
        state.torques = WheelTorques::default();
        state.braked = false;
        Ok(())
    }

    fn brake(&mut self) -> Result<(), ErrorKind> {
        let state = &mut *self.0.borrow_mut();
        state.torques = WheelTorques::default();
        state.braked = true;
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
