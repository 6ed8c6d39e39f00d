//! What can be identified, and what can be stated as known.

use serde::Serialize;

/// A physical quantity. Wheel angles, speeds and torques are those of the wheel, behind the gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "`meaning` says it, with the unit")]
pub enum Quantity {
    RadiusRight,
    RadiusLeft,
    Track,
    Mass,
    Inertia,
    WheelInertia,
    MotorConstantRight,
    MotorConstantLeft,
    ResistanceRight,
    ResistanceLeft,
    ViscousRight,
    ViscousLeft,
    CoulombRight,
    CoulombLeft,
    Supply,
}

use Quantity::*;

/// How many there are.
pub(super) const COUNT: usize = 15;

impl Quantity {
    /// All, in the order of the enumeration.
    pub const ALL: [Self; COUNT] = [
        RadiusRight,
        RadiusLeft,
        Track,
        Mass,
        Inertia,
        WheelInertia,
        MotorConstantRight,
        MotorConstantLeft,
        ResistanceRight,
        ResistanceLeft,
        ViscousRight,
        ViscousLeft,
        CoulombRight,
        CoulombLeft,
        Supply,
    ];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            RadiusRight => "radius_right",
            RadiusLeft => "radius_left",
            Track => "track",
            Mass => "mass",
            Inertia => "inertia",
            WheelInertia => "wheel_inertia",
            MotorConstantRight => "motor_constant_right",
            MotorConstantLeft => "motor_constant_left",
            ResistanceRight => "resistance_right",
            ResistanceLeft => "resistance_left",
            ViscousRight => "viscous_right",
            ViscousLeft => "viscous_left",
            CoulombRight => "coulomb_right",
            CoulombLeft => "coulomb_left",
            Supply => "supply",
        }
    }

    /// The unit.
    pub fn unit(self) -> &'static str {
        match self {
            RadiusRight | RadiusLeft | Track => "m",
            Mass => "kg",
            Inertia | WheelInertia => "kg m^2",
            MotorConstantRight | MotorConstantLeft => "N m/A = V s/rad",
            ResistanceRight | ResistanceLeft => "ohm",
            ViscousRight | ViscousLeft => "N m s/rad",
            CoulombRight | CoulombLeft => "N m",
            Supply => "V",
        }
    }

    /// What it is.
    pub fn meaning(self) -> &'static str {
        match self {
            RadiusRight | RadiusLeft => "rolling radius of the wheel",
            Track => "distance between the wheels' points of contact",
            Mass => {
                "of the whole robot; with wheel_inertia not stated also 2 J / r^2 of the wheels"
            }
            Inertia => {
                "about the vertical axis through the middle of the axle; with wheel_inertia not \
                 stated also J l^2 / (2 r^2) of the wheels"
            }
            WheelInertia => "J of one wheel with rotor times gear squared, about the axle",
            MotorConstantRight | MotorConstantLeft => {
                "torque at the wheel per ampere and back-EMF per wheel speed: gear times the \
                 motor's constant"
            }
            ResistanceRight | ResistanceLeft => "of winding, bridge and leads",
            ViscousRight | ViscousLeft => "friction torque at the wheel per wheel speed",
            CoulombRight | CoulombLeft => "constant friction torque at the wheel",
            Supply => "voltage at full duty",
        }
    }

    /// The place in the order.
    pub(super) fn index(self) -> usize {
        self as usize
    }

    /// Friction may be nothing, and an estimate of it below nothing; all else is positive.
    pub(super) fn is_friction(self) -> bool {
        matches!(
            self,
            ViscousRight | ViscousLeft | CoulombRight | CoulombLeft
        )
    }
}

/// Values that the user states, exact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    values: [Option<f64>; COUNT],
    /// Turns of the motor per turn of the wheel, to give the motor's own constant.
    pub gear: Option<f64>,
}

/// Why a statement is not understood.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum KnownError {
    /// Not NAME=VALUE.
    #[error("`{0}` is not NAME=VALUE")]
    Form(String),
    /// No such name.
    #[error("`{name}` cannot be stated; names are {}, gear", names())]
    Name {
        /// As written.
        name: String,
    },
    /// Out of range.
    #[error("{name}={value}: must be finite and {}", if *.friction { "not negative" } else { "positive" })]
    Value {
        /// As written.
        name: String,
        /// As written.
        value: String,
        /// Friction, which may be nothing.
        friction: bool,
    },
}

fn names() -> String {
    let of_wheels = [
        "radius",
        "motor_constant",
        "resistance",
        "viscous",
        "coulomb",
    ];
    let all = Quantity::ALL.map(Quantity::name);
    format!(
        "{}, or for both sides {}",
        all.join(", "),
        of_wheels.join(", ")
    )
}

impl Known {
    /// The stated value.
    pub fn get(&self, quantity: Quantity) -> Option<f64> {
        self.values[quantity.index()]
    }

    /// States a value.
    pub fn set(&mut self, quantity: Quantity, value: f64) {
        self.values[quantity.index()] = Some(value);
    }

    /// Adds statements as on the command line, `mass=30,track=0.5`; `radius=0.1` states both sides.
    ///
    /// # Errors
    /// What is not understood.
    pub fn state(&mut self, text: &str) -> Result<(), KnownError> {
        for part in text.split(',') {
            let form = || KnownError::Form(part.to_owned());
            let (name, value) = part.split_once('=').ok_or_else(form)?;
            let (name, value) = (name.trim(), value.trim());
            let sides = [format!("{name}_right"), format!("{name}_left")];
            let meant: Vec<_> = Quantity::ALL
                .into_iter()
                .filter(|q| q.name() == name || sides.iter().any(|side| side == q.name()))
                .collect();
            if meant.is_empty() && name != "gear" {
                let name = name.to_owned();
                return Err(KnownError::Name { name });
            }
            // Wheels without inertia are the ordinary assumption, so that may be stated too.
            let zero = meant.iter().all(|q| q.is_friction() || *q == WheelInertia);
            let friction = zero && !meant.is_empty();
            let number = value
                .parse::<f64>()
                .ok()
                .filter(|v| v.is_finite() && (*v > 0.0 || (friction && *v == 0.0)));
            let number = number.ok_or_else(|| KnownError::Value {
                name: name.to_owned(),
                value: value.to_owned(),
                friction,
            })?;
            for quantity in &meant {
                self.set(*quantity, number);
            }
            if meant.is_empty() {
                self.gear = Some(number);
            }
        }
        Ok(())
    }
}
