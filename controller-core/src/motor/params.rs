//! What is known of a motor, its gear, its wheel and its bridge.

use crate::error::{Field, ParamError, Problem};
use crate::motor::dead_band::DeadBand;
use crate::motor::gear::Gear;
use crate::range::{check_ranges, within};
use crate::scalar::Scalar;

/// A measured supply below this share of the nominal one is not believed.
///
/// Every battery chemistry is empty above 60 % of its nominal voltage, and most controllers are off by
/// then: half of it is an unplugged divider, and would double the duty.
pub const MIN_SUPPLY_SHARE: f64 = 0.5;

/// A measured supply above this share of the nominal one is not believed.
///
/// A full battery on its charger is at 1.2; beyond 2 the nominal voltage or the divider is wrong.
pub const MAX_SUPPLY_SHARE: f64 = 2.0;

/// Speed of a wheel at which its stiction is gone, in widths of the blend.
///
/// Wide enough for the estimate of a wheel that just broke loose, which rises over some ticks, to bring
/// the torque down while the wheel is still slow; narrow enough to be gone where the wheel really rolls.
pub(super) const RELEASE: f64 = 10.0;

/// Friction at the wheel that is to be compensated: bearings, gear without load, rolling resistance.
///
/// What is entered here is added to every torque, so enter what was identified or a little less: an
/// overestimate pushes the wheel on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelFriction<T> {
    /// τ_c \[N m\], whatever the speed: 0 to 1e6.
    pub coulomb_nm: T,
    /// τ_s \[N m\]: what it takes beyond τ_c to break a standing wheel loose, 0 to 1e6.
    ///
    /// Without it a base stands a millimetre off until the disturbance estimate has gathered τ_s, and then leaps.
    pub stiction_nm: T,
    /// b \[N m s/rad\], 0 to 1e6.
    pub viscous_nm_s: T,
    /// ω_b \[rad/s\]: up to this desired speed of the wheel the Coulomb part, and the gear's loss, rise in
    /// proportion, and with it what a base finds that nobody has stated ([`crate::base`]). 1e-3 to 1e3; 0 is accepted where there is nothing
    /// to blend: then nothing that is found is compensated either.
    ///
    /// A tenth of the slowest speed at which the wheel is to be exact is good: narrower gains nothing, for the
    /// desired speed passes through it in a few ticks, and wider leaves friction uncompensated there.
    pub blend_rad_s: T,
}

impl<T: Scalar> WheelFriction<T> {
    /// Nothing to compensate.
    pub const NONE: Self = Self {
        coulomb_nm: T::ZERO,
        stiction_nm: T::ZERO,
        viscous_nm_s: T::ZERO,
        blend_rad_s: T::ZERO,
    };
}

/// One motor with gear, wheel and bridge; both sides of a base have the same.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotorParams<T = f32> {
    /// g: motor turns per wheel turn, 0.1 to 1e4.
    pub gear_ratio: T,
    /// η: share of the motor's power that reaches the wheel, 0.2 to 1. A pair of spur wheels has
    /// some 0.95, four of them 0.8, a worm 0.5. Below 1 the blend of `friction` is needed.
    pub gear_efficiency: T,
    /// k_t \[N m/A\], 1e-6 to 100.
    pub torque_constant_nm_per_a: T,
    /// R: winding and bridge \[Ω\], 1e-4 to 1e4.
    pub resistance_ohm: T,
    /// Nominal supply \[V\], 1 to 1000: what is reckoned with while no believable one is measured.
    pub supply_v: T,
    /// i_max: largest current of either motor \[A\], 1e-3 to 1000.
    pub max_current_a: T,
    /// Friction to compensate.
    pub friction: WheelFriction<T>,
    /// d₀: share of the duty that the bridge loses at either sign, 0 to 0.5: its dead time and rise time times the
    /// PWM frequency, and its diodes' voltage as a share of the supply.
    pub dead_band: T,
    /// J_m \[kg m²\], 0 to 10: inertia of the rotor at the motor, and of the gear as the motor feels it. A wheel feels g² J_m; a base
    /// adds that to its mass and inertia ([`BaseParams::new`](crate::base::BaseParams::new)), a motor's command needs none of it.
    pub rotor_inertia_kg_m2: T,
}

/// [`MotorParams`] that passed `validate`, with what follows from them worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor<T> {
    pub(super) params: MotorParams<T>,
    pub(super) gear: Gear<T>,
    pub(super) per_resistance: T,
    pub(super) believable: (T, T),
    pub(super) per_blend: T,
    pub(super) per_release: T,
    pub(super) dead_band: DeadBand<T>,
    pub(super) max_torque: T,
}

impl<T: Scalar> MotorParams<T> {
    /// Inertia of the rotor as the wheel feels it, g² J_m \[kg m²\].
    pub fn rotor_at_wheel_kg_m2(&self) -> T {
        self.gear_ratio * self.gear_ratio * self.rotor_inertia_kg_m2
    }

    /// Checks every parameter and works out what follows from them.
    ///
    /// # Errors
    /// The first one out of its range; [`Field::MaxCurrent`] also if the largest current does not
    /// overcome Coulomb friction.
    pub fn validate(self) -> Result<Motor<T>, ParamError> {
        let (ratio, efficiency) = (self.gear_ratio, self.gear_efficiency);
        let constant = self.torque_constant_nm_per_a;
        let (resistance, supply) = (self.resistance_ohm, self.supply_v);
        let friction = &self.friction;
        let (coulomb, stiction) = (friction.coulomb_nm, friction.stiction_nm);
        check_ranges![
            (Field::GearRatio, ratio, 0.1, 1.0e4),
            (Field::GearEfficiency, efficiency, 0.2, 1.0),
            (Field::TorqueConstant, constant, 1.0e-6, 100.0),
            (Field::Resistance, resistance, 1.0e-4, 1.0e4),
            (Field::Supply, supply, 1.0, 1.0e3),
            (Field::MaxCurrent, self.max_current_a, 1.0e-3, 1.0e3),
            (Field::CoulombFriction, coulomb, 0.0, 1.0e6),
            (Field::Stiction, stiction, 0.0, 1.0e6),
            (Field::ViscousFriction, friction.viscous_nm_s, 0.0, 1.0e6),
        ]?;
        let blends = coulomb > T::ZERO || stiction > T::ZERO || efficiency < T::ONE;
        let given = friction.blend_rad_s != T::ZERO;
        let least = if blends || given { 1.0e-3 } else { 0.0 };
        let blend = within(Field::FrictionBlend, friction.blend_rad_s, least, 1.0e3)?;
        check_ranges![
            (Field::DeadBand, self.dead_band, 0.0, 0.5),
            (Field::RotorInertia, self.rotor_inertia_kg_m2, 0.0, 10.0),
        ]?;
        let gear = Gear::new(ratio * constant, efficiency);
        let max_torque = gear.driving_torque(self.max_current_a) - coulomb;
        if max_torque > T::ZERO {
            Ok(Motor {
                params: self,
                gear,
                per_resistance: T::ONE / resistance,
                believable: (
                    supply * T::from_f64(MIN_SUPPLY_SHARE),
                    supply * T::from_f64(MAX_SUPPLY_SHARE),
                ),
                per_blend: if given { T::ONE / blend } else { T::ZERO },
                per_release: if given {
                    T::ONE / (T::from_f64(RELEASE) * blend)
                } else {
                    T::ZERO
                },
                dead_band: DeadBand::new(self.dead_band),
                max_torque,
            })
        } else {
            let least = gear.current(coulomb, T::ONE).to_f64();
            Err(ParamError {
                field: Field::MaxCurrent,
                problem: Problem::Below(least),
            })
        }
    }
}
