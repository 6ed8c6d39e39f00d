//! The whole plant behind one handle.

use super::actuation::Actuation;
use super::electric::Electric;
use super::error::{ActuationError, WorldError};
use super::gyro::{Gyro, GyroSample};
use super::params::{PatchParams, PushParams, WorldParams};
use super::plant::{Body, Outside};
use super::plant_fault::{PlantFault, PlantFaults};
use super::senses::Senses;
use controller_core::hal::{ErrorKind, WheelCounts};
use controller_core::types::{Measured, Pose, WheelSpeeds, WheelTorques};

/// The longest tick that a plant takes \[µs\].
pub const LONGEST_TICK_US: u32 = 1_000_000;

/// A plant that runs. Nothing moves but in [`advance`](Self::advance).
#[derive(Clone, Debug)]
pub struct World {
    body: Body,
    electric: Electric,
    senses: Senses,
    gyro: Option<Gyro>,
    /// What the gyro gave in the last tick.
    sample: Option<GyroSample>,
    faults: PlantFaults,
    last: Actuation,
    substep_us: u32,
    now_us: u64,
}

impl World {
    /// A robot at `start` with open windings. `seed` settles all noise.
    ///
    /// # Errors
    /// The first parameter out of its range, with its key.
    pub fn new(params: &WorldParams, start: &Measured<f64>, seed: u64) -> Result<Self, WorldError> {
        params.check()?;
        let body = Body::new(params, start);
        let electric = Electric::new(
            (params.motor, params.speed_loop_s),
            &params.battery,
            body.moved(),
        );
        Ok(Self {
            body,
            electric,
            senses: Senses::new(params, seed),
            gyro: Gyro::new(params, start.pose.theta, seed),
            sample: None,
            faults: PlantFaults::default(),
            last: Actuation::Release,
            substep_us: params.substep_us,
            now_us: 0,
        })
    }

    /// Lets `dt_us` pass with a command held, then measures once.
    ///
    /// # Errors
    /// A command or a tick that cannot be; nothing has moved then.
    pub fn advance(&mut self, command: &Actuation, dt_us: u32) -> Result<(), ActuationError> {
        command.check(self.electric.has_motor())?;
        if !(1..=LONGEST_TICK_US).contains(&dt_us) {
            return Err(ActuationError::BadTick);
        }
        let acting = match self.faults.drive_fails {
            Some(true) => Actuation::Release,
            Some(false) => self.last,
            None => *command,
        };
        self.last = acting;
        let steps = dt_us.div_ceil(self.substep_us);
        let h_us = f64::from(dt_us) / f64::from(steps);
        let end_us = self.now_us + u64::from(dt_us);
        let due = |us: Option<u64>| us.is_some_and(|us| us <= end_us);
        let samples = due(self.senses.next_pose_us()) || due(self.gyro.as_ref().map(Gyro::next_us));
        self.body.face();
        for step in 0..steps {
            let from = self.now_us as f64 + f64::from(step) * h_us;
            let before = self.body.pose;
            self.substep(&acting, 1.0e-6 * from, 1.0e-6 * h_us);
            if samples {
                let to = if step + 1 == steps {
                    end_us as f64
                } else {
                    from + h_us
                };
                self.take_poses(before, from, to);
                self.take_turns(before.theta, from, to);
            }
        }
        self.now_us = end_us;
        self.senses.measure(
            self.now_us,
            self.body.angle.0,
            self.electric.measured(),
            &self.faults,
        );
        let now_us = self.now_us;
        self.sample = self.gyro.as_mut().and_then(|gyro| gyro.arrived(now_us));
        Ok(())
    }

    fn substep(&mut self, command: &Actuation, time_s: f64, h: f64) {
        let before = self.body.omega;
        let within = self.body.omega_within(h);
        let [right, left] = self.faults.over_current_a;
        let battery = (self.faults.sag_v, right + left);
        let drive = self.electric.drive(command, [before, within], h, battery);
        let outside = Outside {
            blocked: self.faults.blocked,
            ice: self.faults.ice,
        };
        self.body.substep(&drive, &outside, time_s, h);
        self.electric.settle([before, self.body.omega]);
    }

    /// Poses taken within a substep. Between its ends the way is straight to a h²/8, some 1e-7 m.
    fn take_poses(&mut self, before: Pose<f64>, from: f64, to: f64) {
        while let Some(moment) = self.senses.next_pose_us().map(|us| us as f64) {
            if moment > to {
                return;
            }
            let share = (moment - from) / (to - from);
            let between = |a: f64, b: f64| a + share * (b - a);
            let after = self.body.pose;
            let pose = Pose::new(
                between(before.x, after.x),
                between(before.y, after.y),
                between(before.theta, after.theta),
            );
            self.senses.take_pose(pose, &self.faults);
        }
    }

    /// Samples of the gyro taken within a substep.
    fn take_turns(&mut self, before: f64, from: f64, to: f64) {
        let Some(gyro) = &mut self.gyro else {
            return;
        };
        while gyro.next_us() as f64 <= to {
            let share = (gyro.next_us() as f64 - from) / (to - from);
            let theta = before + share * (self.body.pose.theta - before);
            gyro.take(theta, &self.faults);
        }
    }

    /// What the gyro gave in the last tick.
    pub fn gyro(&self) -> Option<GyroSample> {
        self.sample
    }

    /// The true bias of the gyro \[rad/s\], if there is one.
    pub fn gyro_bias(&self) -> Option<f64> {
        self.gyro.as_ref().map(Gyro::bias)
    }

    /// Length of the next tick \[µs\] of a nominal `period_us`.
    pub fn next_tick_us(&mut self, period_us: u32) -> u32 {
        let late_us = std::mem::take(&mut self.faults.late_us);
        self.senses.next_tick_us(period_us, late_us)
    }

    /// Time since the start \[µs\].
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Pose and twist of the axle's middle as they truly are.
    pub fn truth(&self) -> Measured<f64> {
        self.body.truth()
    }

    /// True speed of the axle's middle to the left \[m/s\]: 0 while rigid tyres hold.
    pub fn sideways(&self) -> f64 {
        self.body.sideways()
    }

    /// Encoder counts at the end of the last tick.
    ///
    /// # Errors
    /// [`ErrorKind::Bus`] under [`PlantFault::EncoderFails`].
    pub fn counts(&self) -> Result<WheelCounts, ErrorKind> {
        if self.faults.encoder_fails {
            return Err(ErrorKind::Bus);
        }
        Ok(self.senses.counts())
    }

    /// The newest external pose that arrived in the last tick, and its age at the end of it \[s\].
    pub fn fix(&self) -> Option<(Pose<f64>, f64)> {
        self.senses.fix
    }

    /// What the drive answered to the last command.
    ///
    /// # Errors
    /// [`ErrorKind::Bus`] or [`ErrorKind::OverCurrent`], under the faults of these names.
    pub fn drive_answer(&self) -> Result<(), ErrorKind> {
        self.faults.drive_answer()
    }

    /// Measured supply voltage \[V\].
    pub fn supply_v(&self) -> f64 {
        self.senses.supply_v
    }

    /// Measured currents of the motors, right and left \[A\]; 0 without motors.
    pub fn currents(&self) -> [f64; 2] {
        self.senses.current_a
    }

    /// Counts of one whole turn of a wheel.
    pub const fn counts_per_turn(&self) -> f64 {
        self.senses.counts_per_turn()
    }

    /// True wheel speeds \[rad/s\].
    pub fn wheel_speeds(&self) -> WheelSpeeds<f64> {
        let [right, left] = self.body.omega.0;
        WheelSpeeds { right, left }
    }

    /// Torques that truly act between wheels and floor \[N m\], in the last substep.
    pub fn torques(&self) -> WheelTorques<f64> {
        let [right, left] = self.body.torques().0;
        WheelTorques { right, left }
    }

    /// Forces of the floor on the right and the left wheel, forward and leftward \[N\].
    pub fn floor_forces(&self) -> [[f64; 2]; 2] {
        let [forward, leftward] = self.body.force;
        [0, 1].map(|i| [forward[i], leftward[i]])
    }

    /// Whether each wheel is at the end of its grip, right and left.
    pub fn slipping(&self) -> [bool; 2] {
        self.body.slipping
    }

    /// Pushes at the centre of mass from now on for `duration_s`: force in the world's x and y \[N\], moment \[N m\].
    pub fn push(&mut self, [force_x_n, force_y_n, moment_nm]: [f64; 3], duration_s: f64) {
        let now_s = 1.0e-6 * self.now_us as f64;
        let past = |push: &PushParams| push.time_s[1] <= now_s;
        self.body.push.retain(|push| !past(push));
        self.body.push.push(PushParams {
            time_s: [now_s, now_s + duration_s],
            force_x_n,
            force_y_n,
            moment_nm,
        });
    }

    /// The places with another grip; the last that holds counts.
    pub const fn patches(&mut self) -> &mut Vec<PatchParams> {
        &mut self.body.floor.patch
    }

    /// Picks the robot up and puts it down elsewhere, at rest: no wheel turns meanwhile, and poses on their way are lost.
    pub fn place(&mut self, pose: Pose<f64>) {
        self.body.place(pose);
        self.senses.forget_poses();
        if let Some(gyro) = &mut self.gyro {
            gyro.place(pose.theta);
        }
    }

    /// Puts a fault in; it stays until it is [healed](Self::heal).
    pub fn inject(&mut self, fault: PlantFault) {
        self.faults.set(fault, true);
    }

    /// Takes out the fault of this kind and side, whatever its amount.
    pub fn heal(&mut self, fault: PlantFault) {
        self.faults.set(fault, false);
    }

    /// Takes out all faults.
    pub fn heal_all(&mut self) {
        self.faults = PlantFaults::default();
    }
}
