//! One wheel command: torque to current, voltage and duty.

use crate::motor::{Motor, MotorParams};
use crate::range::clamp;
use crate::scalar::Scalar;

/// The demand on one wheel, and how it turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelDemand<T> {
    /// τ \[N m\] that is to accelerate the base; friction comes on top.
    pub torque_nm: T,
    /// ω* \[rad/s\]: the speed that the controller commands. For friction and gear only.
    pub desired_speed_rad_s: T,
    /// ω \[rad/s\], measured. For the back-EMF only.
    pub speed_rad_s: T,
    /// Friction beyond the Coulomb part \[N m\], where it is known; else stiction goes by the measured speed.
    pub beyond_coulomb_nm: Option<T>,
}

/// What limited a wheel command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MotorLimited {
    /// The current was limited.
    pub current: bool,
    /// The supply did not suffice.
    pub voltage: bool,
    /// The wheel is driven faster than the supply can hold: the current is above its limit,
    /// against the motion, whatever the duty. Only then.
    pub overspeed: bool,
    /// The measured supply is not finite or not believable; the nominal one was taken.
    pub supply_unknown: bool,
    /// An input, or what came out, is not finite. The command is zero, and the caller releases the
    /// wheels.
    pub invalid: bool,
}

impl MotorLimited {
    /// The wheel gets another torque than demanded.
    pub const fn torque(&self) -> bool {
        // Bits, since all three are at hand: a tick without branches here is shorter.
        self.current | self.voltage | self.invalid
    }
}

/// The command for one motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorCommand<T> {
    /// Torque of the gear at the wheel \[N m\], friction included, after limits.
    pub torque_nm: T,
    /// Part of it that overcomes friction \[N m\]; the rest accelerates the base.
    pub friction_nm: T,
    /// Current of the winding \[A\].
    pub current_a: T,
    /// Mean voltage at the motor \[V\].
    pub voltage_v: T,
    /// Duty to set, in [−1, 1], beyond the dead band; negative drives backward.
    pub duty: T,
    /// What was limited.
    pub limited: MotorLimited,
}

/// What a wheel takes without limits.
struct Asked<T> {
    /// σ in [−1, 1]: the sense of motion that friction and gear go by.
    sense: T,
    /// \[N m\].
    friction: T,
    /// With friction \[N m\].
    torque: T,
    /// \[A\].
    current: T,
    /// \[V\].
    back_emf: T,
}

impl<T: Scalar> Motor<T> {
    /// The parameters as they were given.
    pub const fn params(&self) -> &MotorParams<T> {
        &self.params
    }

    /// Largest torque that may be demanded \[N m\]: η g k_t i_max − τ_c, what the current limit leaves
    /// while driving. Viscous friction and back-EMF take more at speed; then that is reported.
    pub const fn max_torque_nm(&self) -> T {
        self.max_torque
    }

    /// Speed of the wheel at which the back-EMF is the nominal supply \[rad/s\]: U/(g k_t).
    pub fn no_load_speed_rad_s(&self) -> T {
        self.params.supply_v / self.gear.constant
    }

    /// Current of a shorted motor \[A\]: g k_t |ω|/R. Motor and bridge have to bear it when braked.
    pub fn short_current_a(&self, speed_rad_s: T) -> T {
        (self.gear.constant * speed_rad_s).abs() * self.per_resistance
    }

    /// One wheel; equations in the [module](crate::motor).
    ///
    /// `supply_v` is the supply as measured. If it is not finite, below
    /// [`MIN_SUPPLY_SHARE`](crate::motor::MIN_SUPPLY_SHARE) or above
    /// [`MAX_SUPPLY_SHARE`](crate::motor::MAX_SUPPLY_SHARE) of the nominal one, the nominal one is taken and that
    /// is reported.
    ///
    /// The duty is odd in (torque, desired speed, speed), rises with the torque and is continuous. Its Lipschitz
    /// constants, with s = 5, or 1 without a dead band:
    ///
    /// | per | constant |
    /// | --- | --- |
    /// | torque | s R/(η g k_t U) |
    /// | speed | s (g k_t + R τ_s/(10 ω_b η g k_t))/U |
    /// | desired speed | s R/U · (((τ_c + τ_s)/ω_b + b)/(η g k_t) + (1/η² − 1) i_max/(2 ω_b)) |
    ///
    /// All inputs zero give exactly zero.
    #[inline]
    pub fn command(&self, demand: &WheelDemand<T>, supply_v: T) -> MotorCommand<T> {
        let supply = self.believed(supply_v);
        match self.unlimited_command(demand, supply) {
            Some(command) => command,
            None => self.limited_command(demand, supply),
        }
    }

    /// [`command`](Self::command) from a supply that is [`believed`](Self::believed), where neither it nor the current limits, as nearly always.
    #[inline(always)]
    pub(super) fn unlimited_command(
        &self,
        demand: &WheelDemand<T>,
        (supply, supply_unknown): (T, bool),
    ) -> Option<MotorCommand<T>> {
        let asked = self.asked(demand);
        let voltage = self.params.resistance_ohm * asked.current + asked.back_emf;
        // What is no number is within nothing. Without a limit there is no overspeed: the back-EMF is within what both limits leave.
        let unlimited = asked.current.abs() <= self.params.max_current_a
            && voltage.abs() <= supply * self.dead_band.most();
        unlimited.then(|| MotorCommand {
            torque_nm: asked.torque,
            friction_nm: asked.friction,
            current_a: asked.current,
            voltage_v: voltage,
            duty: self.dead_band.beyond(voltage / supply),
            limited: MotorLimited {
                supply_unknown,
                ..MotorLimited::default()
            },
        })
    }

    /// What a demand takes without limits.
    #[inline]
    fn asked(&self, demand: &WheelDemand<T>) -> Asked<T> {
        let friction = &self.params.friction;
        let sense = clamp(demand.desired_speed_rad_s * self.per_blend, T::ONE);
        let beyond = demand
            .beyond_coulomb_nm
            .unwrap_or_else(|| self.stiction_nm(demand.speed_rad_s));
        let level = friction.coulomb_nm + beyond;
        let friction = level * sense + friction.viscous_nm_s * demand.desired_speed_rad_s;
        let torque = demand.torque_nm + friction;
        Asked {
            sense,
            friction,
            torque,
            current: self.gear.current(torque, sense),
            back_emf: self.gear.constant * demand.speed_rad_s,
        }
    }

    /// The command where current or supply may limit it, or where it is no number; without a limit that of
    /// [`unlimited_command`](Self::unlimited_command). Apart, so that a tick does not carry it along.
    #[cold]
    #[inline(never)]
    pub(super) fn limited_command(
        &self,
        demand: &WheelDemand<T>,
        (supply, supply_unknown): (T, bool),
    ) -> MotorCommand<T> {
        let asked = self.asked(demand);
        let MotorParams {
            max_current_a,
            resistance_ohm,
            ..
        } = self.params;
        let allowed = clamp(asked.current, max_current_a);
        let needed = resistance_ohm * allowed + asked.back_emf;
        if !(asked.torque.is_finite() && needed.is_finite()) {
            return MotorCommand {
                limited: MotorLimited {
                    supply_unknown,
                    invalid: true,
                    ..MotorLimited::default()
                },
                ..MotorCommand::default()
            };
        }
        let most = supply * self.dead_band.most();
        let voltage = clamp(needed, most);
        let runaway = most + resistance_ohm * max_current_a;
        let limited = MotorLimited {
            current: asked.current.abs() > max_current_a,
            voltage: needed.abs() > most,
            overspeed: asked.back_emf.abs() > runaway,
            supply_unknown,
            invalid: false,
        };
        let current = if limited.voltage {
            // Below what was allowed, and, but for an overspeed, not below the limit on the other side: there
            // rounding alone passes it.
            let left = (voltage - asked.back_emf) * self.per_resistance;
            if limited.overspeed {
                left
            } else {
                clamp(left, max_current_a)
            }
        } else {
            allowed
        };
        let torque_nm = if limited.current || limited.voltage {
            self.gear.torque(current, asked.sense)
        } else {
            asked.torque
        };
        MotorCommand {
            torque_nm,
            friction_nm: asked.friction,
            current_a: current,
            voltage_v: voltage,
            duty: self.dead_band.beyond(voltage / supply),
            limited,
        }
    }

    /// The stiction that a wheel of this speed has still to overcome \[N m\].
    #[inline]
    pub(crate) fn stiction_nm(&self, speed_rad_s: T) -> T {
        self.params.friction.stiction_nm * self.standing(speed_rad_s)
    }

    /// How much of the stiction that is: 1 at rest, 0 when it rolls.
    fn standing(&self, speed: T) -> T {
        let left = T::ONE - speed.abs() * self.per_release;
        if left > T::ZERO { left } else { T::ZERO }
    }

    /// The supply to reckon with, and whether it is not the measured one.
    pub(super) fn believed(&self, measured: T) -> (T, bool) {
        let (low, high) = self.believable;
        if measured >= low && measured <= high {
            (measured, false)
        } else {
            (self.params.supply_v, true)
        }
    }
}
