//! Battery, drivers and windings: from a command to torque at the wheels.

use super::actuation::Actuation;
use super::pair::Pair;
use super::params::{BatteryParams, MotorParams};
use super::speed_loop::SpeedLoop;
use controller_core::maths::{Libm, Maths};

/// What the motors do to the wheels for one substep: τ = `torque` − `slope` · ω, and the gear
/// holds back `loss` against the motion, all at the wheel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MotorDrives {
    pub torque: Pair,
    pub slope: Pair,
    pub loss: Pair,
}

/// The electrical half of the plant.
#[derive(Clone, Debug)]
pub(super) struct Electric {
    motors: Option<Motors>,
    open_circuit_v: f64,
    loops: [SpeedLoop; 2],
}

/// What feeds a winding.
#[derive(Clone, Copy, Debug)]
enum Feed {
    /// A share of the supply.
    Voltage,
    /// A current source: mean and end of the substep \[A\].
    Current {
        mean: f64,
        end: f64,
    },
    /// A speed loop that demands `at_rest` − `per_speed` ω \[A\].
    Loop {
        at_rest: f64,
        per_speed: f64,
    },
    Open,
}

/// Two motors on a battery.
#[derive(Clone, Debug)]
struct Motors {
    params: MotorParams,
    internal_ohm: f64,
    per_ohm: f64,
    /// Torque at the wheel per current \[N m/A\] and voltage per speed of the wheel \[V s/rad\].
    constant: Pair,
    /// Torque that the gear loses per current \[N m/A\].
    lost: Pair,
    feeds: [Feed; 2],
    /// Of a winding that is fed by a voltage: its share of the supply, 0 for the electrical brake. 0 of others.
    duty: Pair,
    winding: Winding,
    /// Currents at the end of the last substep \[A\].
    current: Pair,
    supply_v: f64,
}

/// What a winding under a held voltage does in a substep of `h` \[s\].
///
/// L di/dt = U − R i − K ω under a held U and a ω that is linear in time: i approaches (U − K ω)/R with L/R, and its mean
/// over h keeps the share φ = (1 − exp(−hR/L)) L/(hR) of the start.
#[derive(Clone, Copy, Debug, Default)]
struct Winding {
    h: f64,
    /// exp(−hR/L), what is left of the start at the end; 0 without inductance.
    left: f64,
    /// φ.
    kept: f64,
    /// (1 − φ)/R.
    share: f64,
    /// Share of the substep at whose speed the current at its end settles: with inductance the half, so that what is stored
    /// balances; without it the whole.
    settles: f64,
}

/// Mean currents of a substep: `at_rest` − `per_speed` ω \[A\].
#[derive(Clone, Copy, Debug)]
struct Mean {
    at_rest: Pair,
    per_speed: Pair,
}

impl Electric {
    pub fn new(
        (params, loop_s): (Option<MotorParams>, f64),
        battery: &BatteryParams,
        moved_kg_m2: Pair,
    ) -> Self {
        let open_circuit_v = battery.open_circuit_v.unwrap_or(battery.nominal_v);
        Self {
            motors: params.map(|params| Motors::new(params, battery.internal_ohm, open_circuit_v)),
            open_circuit_v,
            loops: moved_kg_m2.0.map(|moved| SpeedLoop::new(moved, loop_s)),
        }
    }

    pub fn has_motor(&self) -> bool {
        self.motors.is_some()
    }

    /// Supply voltage \[V\] and currents at the end of the last substep \[A\].
    pub fn measured(&self) -> (f64, [f64; 2]) {
        self.motors
            .as_ref()
            .map_or((self.open_circuit_v, [0.0; 2]), |motors| {
                (motors.supply_v, motors.current.0)
            })
    }

    /// The motors for a substep of `h` \[s\], with wheel speeds `omega` at its start and within it. `sag` stands for
    /// the open-circuit voltage if it is given, `extra_a` is drawn by something else.
    #[inline(always)]
    pub fn drive(
        &mut self,
        command: &Actuation,
        [start, omega]: [Pair; 2],
        h: f64,
        (sag, extra_a): (Option<f64>, f64),
    ) -> MotorDrives {
        if let Actuation::Speed { right, left } = *command {
            for (i, desired) in [right, left].into_iter().enumerate() {
                self.loops[i].follow(desired, start[i], h);
            }
        } else {
            for i in 0..2 {
                self.loops[i].forget(start[i]);
            }
        }
        if let Some(motors) = &mut self.motors {
            let open_v = sag.unwrap_or(self.open_circuit_v);
            motors.drive(command, &mut self.loops, omega, h, (open_v, extra_a))
        } else {
            self.ideal(command, h)
        }
    }

    /// Currents at the end of the substep that [`drive`](Self::drive) began, with wheel speeds `omega` at its start and at its end.
    #[inline(always)]
    pub fn settle(&mut self, omega: [Pair; 2]) {
        if let Some(motors) = &mut self.motors {
            motors.settle(omega);
        }
    }

    /// Torques without motors.
    fn ideal(&mut self, command: &Actuation, h: f64) -> MotorDrives {
        let mut drive = MotorDrives::default();
        match *command {
            Actuation::Torque { right, left } => drive.torque = Pair([right, left]),
            Actuation::Speed { right, left } => {
                for (i, desired) in [right, left].into_iter().enumerate() {
                    let each = &mut self.loops[i];
                    drive.slope.0[i] = each.gain();
                    drive.torque.0[i] = each.gain() * desired + each.integral;
                    each.integrate(h);
                }
            }
            Actuation::Duty { .. } | Actuation::Brake | Actuation::Release => {}
        }
        drive
    }
}

impl Motors {
    fn new(params: MotorParams, internal_ohm: f64, supply_v: f64) -> Self {
        let constant = Pair(params.strength) * params.gear_ratio * params.kt_nm_per_a;
        Self {
            internal_ohm,
            per_ohm: 1.0 / params.resistance_ohm,
            constant,
            lost: (1.0 - params.gear_efficiency) * constant,
            feeds: [Feed::Open; 2],
            duty: Pair::default(),
            winding: Winding::default(),
            current: Pair::default(),
            supply_v,
            params,
        }
    }

    #[inline(always)]
    fn drive(
        &mut self,
        command: &Actuation,
        loops: &mut [SpeedLoop; 2],
        omega: Pair,
        h: f64,
        battery: (f64, f64),
    ) -> MotorDrives {
        if self.winding.h != h {
            self.winding = Winding::new(&self.params, h);
        }
        self.feed(command, loops);
        self.supply_v = self.rail(omega, battery);
        let mut mean = self.mean();
        let mut current = mean.at(omega);
        let limit = Pair::both(self.params.current_limit_a);
        let settled = self.still(omega) * self.per_ohm;
        let end = self.end(settled);
        if self.has_source() || !end.abs().all(limit, |size, limit| size <= limit) {
            let limited = [0, 1].map(|i| self.limit(i, omega[i], current[i], [settled[i], end[i]]));
            for (i, limited) in limited.into_iter().enumerate() {
                // A loop that gets what it demands integrates; at a limit it would only wind up.
                if !limited && let Feed::Loop { .. } = self.feeds[i] {
                    loops[i].integrate(h);
                }
            }
            if limited != [false; 2] {
                self.supply_v = self.rail(omega, battery);
                mean = self.mean();
                current = mean.at(omega);
            }
        }
        MotorDrives {
            torque: self.constant * mean.at_rest,
            slope: self.constant * mean.per_speed,
            // Driving, η of the torque arrives; driven, 1/η ≈ 2 − η is felt. Either way it is a
            // friction in proportion to the torque, which is how teeth lose it.
            loss: self.lost * self.mean_size(current, omega),
        }
    }

    #[inline(always)]
    fn settle(&mut self, [start, end]: [Pair; 2]) {
        let omega = start + self.winding.settles * (end - start);
        let mut current = self.end(self.still(omega) * self.per_ohm);
        if self.has_source() {
            for (i, current) in current.0.iter_mut().enumerate() {
                *current = match self.feeds[i] {
                    Feed::Current { end, .. } => end,
                    _ => self.source(i, end[i]).unwrap_or(*current),
                };
            }
        }
        self.current = current;
    }

    /// Whether anything but a voltage feeds a winding.
    #[inline(always)]
    fn has_source(&self) -> bool {
        !matches!(self.feeds, [Feed::Voltage, Feed::Voltage])
    }

    /// Current that a source drives through winding `i` in the mean of a substep \[A\], if one does.
    fn source(&self, i: usize, omega: f64) -> Option<f64> {
        match self.feeds[i] {
            Feed::Voltage => None,
            Feed::Current { mean, .. } => Some(mean),
            Feed::Loop { at_rest, per_speed } => Some(at_rest - per_speed * omega),
            Feed::Open => Some(0.0),
        }
    }

    /// What the drivers are commanded to feed.
    #[inline(always)]
    fn feed(&mut self, command: &Actuation, loops: &[SpeedLoop; 2]) {
        (self.feeds, self.duty) = match *command {
            Actuation::Duty { right, left } => {
                let duty = Pair([right, left]);
                let acting = (duty.abs() - self.params.dead_band).or_zero();
                ([Feed::Voltage; 2], acting.with(duty, f64::copysign))
            }
            Actuation::Brake => ([Feed::Voltage; 2], Pair::default()),
            Actuation::Torque { right, left } => {
                let current = Pair([right, left]) / self.constant;
                let feed = |current| Feed::Current {
                    mean: current,
                    end: current,
                };
                (current.0.map(feed), Pair::default())
            }
            Actuation::Speed { right, left } => {
                let feed = |i: usize, desired: f64| Feed::Loop {
                    at_rest: (loops[i].gain() * desired + loops[i].integral) / self.constant[i],
                    per_speed: loops[i].gain() / self.constant[i],
                };
                ([feed(0, right), feed(1, left)], Pair::default())
            }
            Actuation::Release => ([Feed::Open; 2], Pair::default()),
        };
    }

    /// Holds winding `i`, which would have a mean of `current`, within current limit and supply; under a voltage its current would
    /// be on its way to `settled` and come to `end`. Whether that changes anything.
    fn limit(&mut self, i: usize, omega: f64, current: f64, [settled, end]: [f64; 2]) -> bool {
        let feed = self.feeds[i];
        if let Feed::Open = feed {
            return false;
        }
        let m = &self.params;
        let limit = m.current_limit_a;
        let bounded = current.clamp(-limit, limit);
        let (mean, end) = if let Feed::Voltage = feed {
            if end.abs() <= limit {
                return false;
            }
            self.reach(i, settled, limit.copysign(end))
        } else {
            let volts = m.resistance_ohm * bounded + self.constant[i] * omega;
            if volts.abs() > self.supply_v {
                self.feeds[i] = Feed::Voltage;
                self.duty.0[i] = 1.0_f64.copysign(volts);
                return true;
            }
            if bounded == current {
                return false;
            }
            (bounded, bounded)
        };
        self.feeds[i] = Feed::Current { mean, end };
        self.duty.0[i] = 0.0;
        true
    }

    /// Mean and end of a current that is held at `bound` \[A\] once it gets there, on its way beyond it to `settled`.
    fn reach(&self, i: usize, settled: f64, bound: f64) -> (f64, f64) {
        let limit = self.params.current_limit_a;
        let from = self.current[i].clamp(-limit, limit);
        let (until, charge) = self.way(from, bound, settled);
        let h = self.winding.h;
        ((charge + bound * (h - until)) / h, bound)
    }

    /// How long a current takes to `bound` on its way from `from` to `settled` \[A\], t = L/R ln(1 + (i_b − i_0)/(i_∞ − i_b)), and its
    /// integral so long \[A s\]: L (i_b − i_0) = R (i_∞ t − ∫ i dt).
    fn way(&self, from: f64, bound: f64, settled: f64) -> (f64, f64) {
        let lag = self.params.inductance_h / self.params.resistance_ohm;
        let until = lag * libm::log1p((bound - from) / (settled - bound));
        (until, settled * until - lag * (bound - from))
    }

    /// Voltage of the supply: V = V₀ − R_b I, where a driver with duty D draws D i, i the mean of the substep, and one that
    /// holds a current draws the power of its motor, (R i + K ω) i / V. Quadratic in V; a battery
    /// that cannot give the power collapses to half of its voltage, where it gives most.
    #[inline(always)]
    fn rail(&self, omega: Pair, (open_v, extra_a): (f64, f64)) -> f64 {
        let Self { duty, winding, .. } = self;
        let back = self.constant * omega;
        let conductance = *duty * *duty * winding.share;
        let given =
            self.internal_ohm * *duty * (winding.share * back - winding.kept * self.current);
        let source = open_v - self.internal_ohm * extra_a + given[0] + given[1];
        let whole = 1.0 + self.internal_ohm * (conductance[0] + conductance[1]);
        let mut power = 0.0;
        if self.has_source() {
            for i in 0..2 {
                if let Some(current) = self.source(i, omega[i]) {
                    power += (self.params.resistance_ohm * current + back[i]) * current;
                }
            }
        }
        if power == 0.0 {
            // What is below as well, to the last bit: the root of a square is exact.
            return if source > 0.0 { source / whole } else { 0.0 };
        }
        let inside = source * source - 4.0 * whole * self.internal_ohm * power;
        ((source + inside.max(0.0).sqrt()) / (2.0 * whole)).max(0.0)
    }

    /// Mean currents of a substep.
    #[inline(always)]
    fn mean(&self) -> Mean {
        let Winding { share, kept, .. } = self.winding;
        let mut mean = Mean {
            at_rest: share * self.duty * self.supply_v + kept * self.current,
            per_speed: share * self.constant,
        };
        if self.has_source() {
            for i in 0..2 {
                (mean.at_rest.0[i], mean.per_speed.0[i]) = match self.feeds[i] {
                    Feed::Voltage => continue,
                    Feed::Current { mean, .. } => (mean, 0.0),
                    Feed::Loop { at_rest, per_speed } => (at_rest, per_speed),
                    Feed::Open => (0.0, 0.0),
                };
            }
        }
        mean
    }

    /// Voltages that act on windings at rest \[V\].
    #[inline(always)]
    fn still(&self, omega: Pair) -> Pair {
        self.duty * self.supply_v - self.constant * omega
    }

    /// Currents at the end of a substep, on their way to `settled`.
    #[inline(always)]
    fn end(&self, settled: Pair) -> Pair {
        settled + (self.current - settled) * self.winding.left
    }

    /// Mean of |i| over a substep whose mean current is `mean`: larger than |`mean`| where i passes 0 within it.
    #[inline(always)]
    fn mean_size(&self, mean: Pair, omega: Pair) -> Pair {
        // None passes 0 on its way to a current of its sign.
        let still = self.still(omega);
        if self.current.all(still, |from, still| from * still >= 0.0) {
            return mean.abs();
        }
        self.mean_size_through_zero(mean, still)
    }

    fn mean_size_through_zero(&self, mean: Pair, still: Pair) -> Pair {
        let settled = still * self.per_ohm;
        let end = self.end(settled);
        Pair([0, 1].map(|i| {
            let (mean, from, settled) = (mean[i], self.current[i], settled[i]);
            let fed = matches!(self.feeds[i], Feed::Voltage);
            if !fed || self.params.inductance_h <= 0.0 || from * end[i] >= 0.0 {
                return mean.abs();
            }
            let (_, charge) = self.way(from, 0.0, settled);
            let before = charge / self.winding.h;
            before.abs() + (mean - before).abs()
        }))
    }
}

impl Winding {
    fn new(m: &MotorParams, h: f64) -> Self {
        let (risen, kept, settles) = if m.inductance_h > 0.0 {
            let risen = -Libm::exp_m1(-h * m.resistance_ohm / m.inductance_h);
            let kept = risen * m.inductance_h / (h * m.resistance_ohm);
            (risen, kept, 0.5)
        } else {
            (1.0, 0.0, 1.0)
        };
        Self {
            h,
            left: 1.0 - risen,
            kept,
            share: (1.0 - kept) / m.resistance_ohm,
            settles,
        }
    }
}

impl Mean {
    #[inline(always)]
    fn at(&self, omega: Pair) -> Pair {
        self.at_rest - self.per_speed * omega
    }
}
