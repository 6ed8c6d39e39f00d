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

/// A statement with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stated {
    /// Value.
    pub value: f64,
    /// Standard deviation, 0 if it is exact.
    pub deviation: f64,
}

/// Values that the user states: quantities as exact, what lies between command and wheel with its uncertainty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    values: [Option<f64>; COUNT],
    /// Turns of the motor per turn of the wheel, to give the motor's own constant.
    pub gear: Option<f64>,
    /// Share of the motors' torque that their gears let through.
    pub efficiency: Option<Stated>,
    /// Share of full duty that the drivers lose at either sign.
    pub dead_band: Option<Stated>,
    /// Current at which the drivers hold a motor \[A\].
    pub current_limit_a: Option<f64>,
}

/// Why a statement is not understood.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum KnownError {
    /// Not NAME=VALUE.
    #[error("`{0}` is not NAME=VALUE")]
    Form(String),
    /// No such name.
    #[error("`{name}` cannot be stated; names are {}, {}", names(), DRIVETRAIN.join(", "))]
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
    /// A value of what has one already.
    #[error("{0} is stated twice")]
    Twice(String),
    /// An uncertainty of what counts as exact.
    #[error("{0} counts as exact: only efficiency and dead_band can have +-")]
    Exact(String),
}

/// What can be stated besides quantities.
const DRIVETRAIN: [&str; 4] = ["gear", "efficiency", "dead_band", "current_limit"];
/// Half of a 95 % interval in standard deviations.
const HALF_WIDTH: f64 = 1.96;

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

    /// Adds statements as on the command line, `mass=30,track=0.5`; `radius=0.1` states both sides,
    /// `efficiency=0.8+-0.05` half of its 95 % interval too.
    ///
    /// # Errors
    /// What is not understood.
    pub fn state(&mut self, text: &str) -> Result<(), KnownError> {
        for part in text.split(',') {
            let form = || KnownError::Form(part.to_owned());
            let (name, value) = part.split_once('=').ok_or_else(form)?;
            let (name, value) = (name.trim(), value.trim());
            if DRIVETRAIN.contains(&name) {
                self.state_drivetrain(name, value)?;
                continue;
            }
            let sides = [format!("{name}_right"), format!("{name}_left")];
            let meant: Vec<_> = Quantity::ALL
                .into_iter()
                .filter(|q| q.name() == name || sides.iter().any(|side| side == q.name()))
                .collect();
            if meant.is_empty() {
                let name = name.to_owned();
                return Err(KnownError::Name { name });
            }
            // Wheels without inertia are the ordinary assumption, so that may be stated too.
            let zero = meant.iter().all(|q| q.is_friction() || *q == WheelInertia);
            let number = number(name, value, zero)?;
            for quantity in &meant {
                if self.get(*quantity).is_some() {
                    return Err(KnownError::Twice(quantity.name().to_owned()));
                }
                self.set(*quantity, number);
            }
        }
        Ok(())
    }

    fn state_drivetrain(&mut self, name: &str, text: &str) -> Result<(), KnownError> {
        let (value, half_width) = text.split_once("+-").unwrap_or((text, "0"));
        let stated = Stated {
            value: number(name, value.trim(), name == "dead_band")?,
            deviation: number(name, half_width.trim(), true)? / HALF_WIDTH,
        };
        let twice = match name {
            "efficiency" => self.efficiency.replace(stated).is_some(),
            "dead_band" => self.dead_band.replace(stated).is_some(),
            // Stated as exact.
            _ if stated.deviation > 0.0 => return Err(KnownError::Exact(name.to_owned())),
            "gear" => self.gear.replace(stated.value).is_some(),
            _ => self.current_limit_a.replace(stated.value).is_some(),
        };
        match twice {
            true => Err(KnownError::Twice(name.to_owned())),
            false => Ok(()),
        }
    }
}

fn number(name: &str, text: &str, zero: bool) -> Result<f64, KnownError> {
    let number = text.parse::<f64>().ok();
    let number = number.filter(|v| v.is_finite() && (*v > 0.0 || (zero && *v == 0.0)));
    number.ok_or_else(|| KnownError::Value {
        name: name.to_owned(),
        value: text.to_owned(),
        friction: zero,
    })
}
