//! Battery, drivers and windings: from a command to torque at the wheels.

use super::actuation::Actuation;
use super::params::{BatteryParams, MotorParams, SPEED_LOOP_S};
use controller_core::maths::{Libm, Maths};

/// What the motors do to the wheels for one substep: τ = `torque` − `slope` · ω, and the gear
/// holds back `loss` against the motion, all at the wheel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MotorDrives {
    pub torque: [f64; 2],
    pub slope: [f64; 2],
    pub loss: [f64; 2],
}

/// How a motor is fed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Feed {
    /// A share of the supply; 0 is the electrical brake.
    Voltage(f64),
    /// A current source \[A\].
    Current(f64),
    /// Speed loop that demands `at_rest` − `per_speed` ω \[A\].
    Loop {
        at_rest: f64,
        per_speed: f64,
    },
    Open,
}

/// The electrical half of the plant.
#[derive(Clone, Debug)]
pub(super) struct Electric {
    motor: Option<MotorParams>,
    open_circuit_v: f64,
    internal_ohm: f64,
    /// Torque at the wheel per current \[N m/A\] and voltage per speed of the wheel \[V s/rad\].
    constant: [f64; 2],
    /// Half the body and a wheel, as the speed loop of each driver sees them \[kg m²\].
    moved_kg_m2: [f64; 2],
    feeds: [Feed; 2],
    /// Speed that each loop's model has reached, and the torque that it has integrated.
    model: [f64; 2],
    /// What each wheel lacked of its model at the start of the substep.
    behind: [f64; 2],
    integral: [f64; 2],
    /// [`risen`] of the substep that it was worked out for: all but a few are as long.
    risen: (f64, f64),
    /// Currents at the end of the last substep \[A\].
    pub current: [f64; 2],
    pub supply_v: f64,
}

impl Electric {
    pub fn new(motor: Option<MotorParams>, battery: &BatteryParams, moved_kg_m2: [f64; 2]) -> Self {
        let open_circuit_v = battery.open_circuit_v.unwrap_or(battery.nominal_v);
        let constant = motor.map_or([1.0; 2], |m| {
            m.strength.map(|s| s * m.gear_ratio * m.kt_nm_per_a)
        });
        Self {
            motor,
            open_circuit_v,
            internal_ohm: battery.internal_ohm,
            constant,
            moved_kg_m2,
            feeds: [Feed::Open; 2],
            model: [0.0; 2],
            behind: [0.0; 2],
            integral: [0.0; 2],
            risen: (0.0, 0.0),
            current: [0.0; 2],
            supply_v: open_circuit_v,
        }
    }

    pub fn has_motor(&self) -> bool {
        self.motor.is_some()
    }

    /// The motors for a substep of `h` \[s\] that starts at wheel speeds `omega`. `sag` stands for
    /// the open-circuit voltage if it is given, `extra_a` is drawn by something else.
    pub fn drive(
        &mut self,
        command: &Actuation,
        omega: [f64; 2],
        h: f64,
        (sag, extra_a): (Option<f64>, f64),
    ) -> MotorDrives {
        let Some(motor) = self.motor else {
            return self.ideal(command, omega, h);
        };
        if self.risen.0 != h {
            self.risen = (h, risen(&motor, h));
        }
        let open_v = sag.unwrap_or(self.open_circuit_v);
        self.feeds = [0, 1].map(|i| self.desired(command, i, omega[i], h, &motor));
        self.supply_v = self.rail(&motor, omega, h, (open_v, extra_a));
        let limited = [0, 1].map(|i| self.limited(&motor, i, omega[i], h));
        // A loop that gets what it demands integrates; at a limit it would only wind up.
        if let Actuation::Speed { .. } = command {
            for (i, feed) in limited.iter().enumerate() {
                if matches!(feed, Feed::Loop { .. }) {
                    self.integrate(i, h, motor.speed_loop_s);
                }
            }
        }
        if self.feeds != limited {
            self.feeds = limited;
            self.supply_v = self.rail(&motor, omega, h, (open_v, extra_a));
        }
        let mut drive = MotorDrives::default();
        for (i, omega) in omega.into_iter().enumerate() {
            let (at_rest, per_speed) = self.mean_current(&motor, i, h);
            drive.torque[i] = self.constant[i] * at_rest;
            drive.slope[i] = self.constant[i] * per_speed;
            let current = self.mean_size(&motor, i, at_rest - per_speed * omega, omega, h);
            // Driving, η of the torque arrives; driven, 1/η ≈ 2 − η is felt. Either way it is a
            // friction in proportion to the torque, which is how teeth lose it.
            drive.loss[i] = (1.0 - motor.gear_efficiency) * self.constant[i] * current;
        }
        drive
    }

    /// Currents at the end of the substep that [`drive`](Self::drive) began, over which the wheels turned at `omega` on average.
    pub fn settle(&mut self, omega: [f64; 2]) {
        let Some(motor) = self.motor else { return };
        for (i, omega) in omega.into_iter().enumerate() {
            self.current[i] = match self.feeds[i] {
                Feed::Voltage(duty) => {
                    let still = duty * self.supply_v - self.constant[i] * omega;
                    let settled = still / motor.resistance_ohm;
                    settled + (self.current[i] - settled) * (1.0 - self.risen.1)
                }
                Feed::Current(current) => current,
                Feed::Loop { at_rest, per_speed } => at_rest - per_speed * omega,
                Feed::Open => 0.0,
            };
        }
    }

    /// Torques without motors.
    fn ideal(&mut self, command: &Actuation, omega: [f64; 2], h: f64) -> MotorDrives {
        let mut drive = MotorDrives::default();
        match *command {
            Actuation::Torque { right, left } => drive.torque = [right, left],
            Actuation::Speed { right, left } => {
                for (i, desired) in [right, left].into_iter().enumerate() {
                    let loop_s = SPEED_LOOP_S;
                    let gain = self.moved_kg_m2[i] / loop_s;
                    self.follow(i, desired, omega[i], h, loop_s);
                    drive.torque[i] = gain * desired + self.integral[i];
                    drive.slope[i] = gain;
                    self.integrate(i, h, loop_s);
                }
                return drive;
            }
            Actuation::Duty { .. } | Actuation::Brake | Actuation::Release => {}
        }
        self.forget(omega);
        drive
    }

    fn desired(
        &mut self,
        command: &Actuation,
        i: usize,
        omega: f64,
        h: f64,
        m: &MotorParams,
    ) -> Feed {
        let pick = |right, left| if i == 0 { right } else { left };
        if let Actuation::Speed { right, left } = *command {
            let desired = pick(right, left);
            let gain = self.moved_kg_m2[i] / m.speed_loop_s;
            self.follow(i, desired, omega, h, m.speed_loop_s);
            return Feed::Loop {
                at_rest: (gain * desired + self.integral[i]) / self.constant[i],
                per_speed: gain / self.constant[i],
            };
        }
        self.model[i] = omega;
        self.integral[i] = 0.0;
        match *command {
            Actuation::Duty { right, left } => {
                let duty: f64 = pick(right, left);
                let acting = (duty.abs() - m.dead_band).max(0.0);
                Feed::Voltage(acting.copysign(duty))
            }
            Actuation::Torque { right, left } => {
                Feed::Current(pick(right, left) / self.constant[i])
            }
            Actuation::Brake => Feed::Voltage(0.0),
            Actuation::Release | Actuation::Speed { .. } => Feed::Open,
        }
    }

    /// What current limit and supply leave of a feed.
    fn limited(&self, m: &MotorParams, i: usize, omega: f64, h: f64) -> Feed {
        let feed = self.feeds[i];
        let current = match feed {
            Feed::Voltage(_) => {
                let (at_rest, per_speed) = self.mean_current(m, i, h);
                at_rest - per_speed * omega
            }
            Feed::Current(current) => current,
            Feed::Loop { at_rest, per_speed } => at_rest - per_speed * omega,
            Feed::Open => return feed,
        };
        let bounded = current.clamp(-m.current_limit_a, m.current_limit_a);
        if !matches!(feed, Feed::Voltage(_)) {
            let volts = m.resistance_ohm * bounded + self.constant[i] * omega;
            if volts.abs() > self.supply_v {
                return Feed::Voltage(1.0_f64.copysign(volts));
            }
        }
        if bounded == current {
            feed
        } else {
            Feed::Current(bounded)
        }
    }

    /// Voltage of the supply: V = V₀ − R_b I, where a driver with duty D draws D i, i the mean of the substep, and one that
    /// holds a current draws the power of its motor, (R i + K ω) i / V. Quadratic in V; a battery
    /// that cannot give the power collapses to half of its voltage, where it gives most.
    fn rail(&self, m: &MotorParams, omega: [f64; 2], h: f64, (open_v, extra_a): (f64, f64)) -> f64 {
        let mut source = open_v - self.internal_ohm * extra_a;
        let (mut conductance, mut power) = (0.0, 0.0);
        for (i, omega) in omega.into_iter().enumerate() {
            let back = self.constant[i] * omega;
            let mut held = |current: f64| power += (m.resistance_ohm * current + back) * current;
            match self.feeds[i] {
                Feed::Voltage(duty) => {
                    let kept = self.kept(m, h);
                    let share = (1.0 - kept) / m.resistance_ohm;
                    conductance += duty * duty * share;
                    source += self.internal_ohm * duty * (share * back - kept * self.current[i]);
                }
                Feed::Current(current) => held(current),
                Feed::Loop { at_rest, per_speed } => held(at_rest - per_speed * omega),
                Feed::Open => {}
            }
        }
        if conductance == 0.0 && power == 0.0 {
            // What is below as well, to the last bit.
            return source.max(0.0);
        }
        let whole = 1.0 + self.internal_ohm * conductance;
        let inside = source * source - 4.0 * whole * self.internal_ohm * power;
        ((source + inside.max(0.0).sqrt()) / (2.0 * whole)).max(0.0)
    }

    /// Mean current of a substep as (at rest, less per speed of the wheel).
    ///
    /// L di/dt = U − R i − K ω under held U and ω: i approaches (U − K ω)/R with L/R, and its mean
    /// over h keeps the share φ = (1 − exp(−hR/L)) L/(hR) of the start.
    fn mean_current(&self, m: &MotorParams, i: usize, h: f64) -> (f64, f64) {
        match self.feeds[i] {
            Feed::Voltage(duty) => {
                let kept = self.kept(m, h);
                let share = (1.0 - kept) / m.resistance_ohm;
                (
                    share * duty * self.supply_v + kept * self.current[i],
                    share * self.constant[i],
                )
            }
            Feed::Current(current) => (current, 0.0),
            Feed::Loop { at_rest, per_speed } => (at_rest, per_speed),
            Feed::Open => (0.0, 0.0),
        }
    }

    /// The share φ of a substep's first current in its mean, under a held voltage.
    fn kept(&self, m: &MotorParams, h: f64) -> f64 {
        if m.inductance_h > 0.0 {
            self.risen.1 * m.inductance_h / (h * m.resistance_ohm)
        } else {
            0.0
        }
    }

    /// Mean of |i| over a substep whose mean current is `mean`: larger than |`mean`| where i passes 0 within it, which it does
    /// at t = L/R ln(1 − i_0/i_∞).
    fn mean_size(&self, m: &MotorParams, i: usize, mean: f64, omega: f64, h: f64) -> f64 {
        let Feed::Voltage(duty) = self.feeds[i] else {
            return mean.abs();
        };
        let settled = (duty * self.supply_v - self.constant[i] * omega) / m.resistance_ohm;
        let from = self.current[i];
        let to = settled + (from - settled) * (1.0 - self.risen.1);
        if m.inductance_h <= 0.0 || from * to >= 0.0 {
            return mean.abs();
        }
        let lag = m.inductance_h / m.resistance_ohm;
        let until = lag * libm::log1p(-from / settled);
        // At i = 0 the share from/(from - settled) of the way has been gone.
        let before = (settled * until + lag * from) / h;
        before.abs() + (mean - before).abs()
    }

    /// The model of the speed loop: ω_m' = (ω_c − ω_m)/T, exactly.
    fn follow(&mut self, i: usize, desired: f64, omega: f64, h: f64, loop_s: f64) {
        self.behind[i] = self.model[i] - omega;
        self.model[i] -= (desired - self.model[i]) * Libm::exp_m1(-h / loop_s);
    }

    /// What the wheel lacks of the model is a load. J e' = −(J/T) e − z + load with z' = J/(4T²) e
    /// is critically damped; without load the model is met and z stays 0.
    fn integrate(&mut self, i: usize, h: f64, loop_s: f64) {
        let gain = self.moved_kg_m2[i] / (4.0 * loop_s * loop_s);
        self.integral[i] += h * gain * self.behind[i];
    }

    fn forget(&mut self, omega: [f64; 2]) {
        self.model = omega;
        self.integral = [0.0; 2];
    }
}

/// 1 − exp(−hR/L); 1 without inductance.
fn risen(m: &MotorParams, h: f64) -> f64 {
    if m.inductance_h > 0.0 {
        -Libm::exp_m1(-h * m.resistance_ohm / m.inductance_h)
    } else {
        1.0
    }
}
