//! Identification of a robot from a log: lengths, inertia, friction and motor constants, each with
//! its 95 % interval, or the reason why this log does not determine it.
//!
//! | step | module |
//! | --- | --- |
//! | read the log | [`log`] |
//! | rows that are missing, angles that jump, currents of the wrong sign | `rows` |
//! | radii and track from poses: dead reckoning with free start poses | `kinematics` |
//! | wheel motion and current from commands: simulated stretches with free start states | `stretches`, `wheels`, `motor`, `start`, `dynamics` |
//! | lags, gear losses and dead bands, fitted with the rest; the battery behind the supply | `drivetrain`, `source` |
//! | both are least squares; correlated residuals count as fewer rows | `fit`, `correlation` |
//! | physical quantities from the fitted numbers and what is stated | [`quantity`], `physics`, `direct`, `combine` |
//! | whether there can be such a robot | `grip`, [`crate::plausible`] |
//! | what cannot be determined, and what would determine it | [`structure`], `verdict`, `products` |
//! | table, file | [`report`], [`profile`] |
//! | a drive of a live base, recorded | [`live`] |
//! | logs of a base as its file has it, and how often intervals hold there | [`record`], [`coverage`] |
//!
//! `docs/identify.md` has the columns and the drive to record.

#[cfg(feature = "datalog")]
mod bag;
mod combine;
mod correlation;
pub mod coverage;
mod direct;
mod drivetrain;
mod dynamics;
mod fit;
mod grip;
mod kinematics;
pub mod live;
pub mod log;
mod motor;
mod physics;
mod products;
pub mod profile;
pub mod quantity;
pub mod record;
pub mod report;
mod ride;
mod rows;
mod source;
mod start;
mod stretches;
pub mod structure;
mod verdict;
mod wheels;

#[cfg(feature = "datalog")]
pub use bag::Topics;
pub use kinematics::WINDOW_S;
pub use log::{Drive, Fix, Log, LogError};
pub use quantity::{Known, KnownError, Quantity, Stated};
pub use stretches::{LONGEST_S, SHORTEST_S};
pub use structure::Given;

use crate::numbers::{digits, least, most, refused};
use crate::plausible::{self, Impossible};
use controller_core::error::{Field, ParamError, Problem};
use controller_core::paper::params::Params;
use controller_core::robot::Robot;
use controller_core::wheels::{WheelGeometry, WheelMap};
use serde::Serialize;

/// How a log is read.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// What the user states.
    pub known: Known,
    /// Age of an external pose in the row that it stands in \[s\].
    pub latency_s: f64,
    /// Wheel speed \[rad/s\] below which friction is no longer Coulomb's and the log is not used.
    pub slow_rad_s: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            known: Known::default(),
            latency_s: 0.0,
            // Half a turn in six seconds: above stiction and Stribeck's dip of small gear motors.
            slow_rad_s: 0.5,
        }
    }
}

/// What is said of a quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "verdict")]
pub enum Verdict {
    /// By the user.
    Stated {
        /// As stated.
        value: f64,
    },
    /// From the log.
    Identified {
        /// Estimate.
        value: f64,
        /// Half the width of the 95 % interval about it.
        half_width: f64,
    },
    /// By no means.
    NotIdentifiable {
        /// Why not.
        why: String,
        /// Each of these would change that.
        would_help: Vec<String>,
    },
}

/// A quantity and what is said of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// What is said of it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl Entry {
    fn new(name: &str, unit: &'static str, meaning: &'static str, verdict: Verdict) -> Self {
        Self {
            name: name.to_owned(),
            unit,
            meaning,
            verdict,
        }
    }
}

/// What a log determines.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Identified {
    /// Every quantity that the commands have a part for.
    pub quantities: Vec<Entry>,
    /// Ratios and products that are known although their parts are not.
    pub combinations: Vec<Entry>,
    /// What makes the figures doubtful.
    pub warnings: Vec<String>,
    /// Stretches of the log that were used for the motion.
    pub stretches: usize,
    /// Windows of poses that were used.
    pub pose_windows: usize,
}

impl Identified {
    /// What is said of a quantity.
    pub fn of(&self, quantity: Quantity) -> Option<&Verdict> {
        let mut entries = self.quantities.iter();
        Some(&entries.find(|e| e.name == quantity.name())?.verdict)
    }

    /// What the log says, or what was stated.
    pub(crate) fn value(&self, quantity: Quantity) -> Option<f64> {
        match self.of(quantity)? {
            Verdict::Stated { value } | Verdict::Identified { value, .. } => Some(*value),
            Verdict::NotIdentifiable { .. } => None,
        }
    }

    /// Whether there can be a robot of these lengths, with this mass and inertia as far as they are known, that drives as in the log.
    fn can_be(&self, log: &Log) -> Result<(), IdentifyError> {
        use Quantity as Q;
        let lengths = [Q::RadiusRight, Q::RadiusLeft, Q::Track].map(|length| self.value(length));
        let [Some(radius_right_m), Some(radius_left_m), Some(track_m)] = lengths else {
            return Ok(());
        };
        let wheels = WheelGeometry {
            radius_right_m,
            radius_left_m,
            track_m,
        };
        if let Some(mass_kg) = self.value(Q::Mass) {
            plausible::body(&wheels, mass_kg, self.value(Q::Inertia))?;
        }
        match grip::acceleration_m_s2(log, &wheels) {
            Some(accel_m_s2) if accel_m_s2 > grip::MOST_M_S2 => {
                Err(IdentifyError::Grip { accel_m_s2 })
            }
            _ => Ok(()),
        }
    }

    /// Whether the core would take the robot; what is not known of it is the paper's.
    fn plausible(&self) -> Result<(), IdentifyError> {
        use Quantity as Q;
        let paper = Robot::<f64>::paper();
        let value = |quantity, else_| self.value(quantity).unwrap_or(else_);
        let robot = Robot {
            mass_kg: value(Q::Mass, paper.mass_kg),
            inertia_kg_m2: value(Q::Inertia, paper.inertia_kg_m2),
            wheels: WheelGeometry {
                radius_right_m: value(Q::RadiusRight, paper.wheels.radius_right_m),
                radius_left_m: value(Q::RadiusLeft, paper.wheels.radius_left_m),
                track_m: value(Q::Track, paper.wheels.track_m),
            },
        };
        let params = Params {
            robot,
            ..Params::paper()
        };
        // Lengths first: masses follow from them.
        let lengths = WheelMap::from_geometry(&robot.wheels);
        let Err(ParamError { field, problem }) = lengths.and_then(|_| params.validate()) else {
            return Ok(());
        };
        let of_field = [
            (Field::Mass, Q::Mass),
            (Field::Inertia, Q::Inertia),
            (Field::RadiusRight, Q::RadiusRight),
            (Field::RadiusLeft, Q::RadiusLeft),
            (Field::Track, Q::Track),
        ];
        let wrong = of_field.into_iter().find(|(of, _)| *of == field);
        match wrong.and_then(|(_, quantity)| Some((quantity, self.value(quantity)?))) {
            Some((quantity, value)) => Err(IdentifyError::Implausible {
                quantity: quantity.name(),
                unit: quantity.unit(),
                value,
                problem,
            }),
            None => Ok(()),
        }
    }
}

/// Why nothing can be identified from a log that can be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Shorter than [`SHORTEST_LOG_S`].
    #[error(
        "the log lasts {} s, and at least {SHORTEST_LOG_S} s are needed: in less, wheels that are not yet as fast as their commands make them \
         look like ones that go against these",
        refused(*.0, SHORTEST_LOG_S)
    )]
    Short(f64),
    /// Wheel angles fall where the poses go forward.
    #[error("the {0} wheel's angle falls where the external pose moves forward: encoder reversed?")]
    Backwards(&'static str),
    /// A positive command slows the wheel's forward turn down.
    #[error(
        "the {0} wheel accelerates against its command: command, motor or encoder reversed, or \
         sides swapped?"
    )]
    Against(&'static str),
    /// Wheels turn the robot the other way than the poses do.
    #[error(
        "the robot turns to the right by its poses where it turns to the left by its wheels: sides swapped, or is theta clockwise, \
         or y to the right?"
    )]
    Mirrored,
    /// Headings that no wheels follow.
    #[error(
        "headings of the poses are {off_rad:.1} rad off those by the wheels (root mean square), which is nearly any heading: is \
         theta in rad?"
    )]
    Headings {
        /// Root mean square.
        off_rad: f64,
    },
    /// A wheel's angle jumps.
    #[error(
        "the {side} wheel's angle jumps by {step_rad:.3} rad in one row, to t = {t_s} s: a counter that wraps or was reset, counts \
         that were lost, a damaged row?"
    )]
    Jump {
        /// The wheel.
        side: &'static str,
        /// Of the row after the jump.
        t_s: f64,
        /// How far.
        step_rad: f64,
    },
    /// A wheel's angle stays while its motor is driven and the other wheel turns.
    #[error("the {0} wheel's angle never changes, whatever its command: is the encoder connected?")]
    Still(&'static str),
    /// A current flows against its command.
    #[error(
        "the {side} motor's current flows against its {commands} commands: has the sensor no sign, or the wrong one?"
    )]
    Current {
        /// The motor.
        side: &'static str,
        /// Which ones.
        commands: &'static str,
    },
    /// A quantity that no file of a base can have.
    #[error("{quantity} comes out as {}: {UNITS}", beyond(*value, unit, problem))]
    Implausible {
        /// Its name.
        quantity: &'static str,
        /// Its unit.
        unit: &'static str,
        /// What it would be.
        value: f64,
        /// The limit that it is beyond.
        problem: Problem,
    },
    /// A body that no robot on its wheels has.
    #[error("the robot comes out as none that can be: {0}: {UNITS}")]
    Impossible(#[from] Impossible),
    /// Accelerations that no tyre holds.
    #[error(
        "by its wheels the robot accelerates at {accel_m_s2:.0} m/s², and none on tyres does at more than {:.0}: {UNITS}",
        grip::MOST_M_S2
    )]
    Grip {
        /// By the wheels.
        accel_m_s2: f64,
    },
}

/// What makes robots that there are not.
const UNITS: &str = "is the log in SI units (t in s, x and y in m, theta in rad, torques in N m) and --counts-per-turn that of the wheel?";

fn beyond(value: f64, unit: &str, problem: &Problem) -> String {
    let (limit, taken) = match problem {
        Problem::Below(limit) => (*limit, format!("at least {}", least(*limit))),
        Problem::Above(limit) => (*limit, format!("at most {}", most(*limit))),
        _ => return format!("{} {unit}, which no robot has", digits(value)),
    };
    format!("{} {unit}, and a robot has {taken}", refused(value, limit))
}

/// Shortest log \[s\]. Of 20 drives each whose wheels settle in 0.05 to 1 s, 13 of 0.5 s and 4 of 1 s looked like wheels that go against
/// their commands, none of 1.5 s or more.
pub const SHORTEST_LOG_S: f64 = 2.0;

const SIDES: [&str; 2] = ["right", "left"];

/// An interval wider than half its value to each side is no identification.
const VAGUE: f64 = 0.5;

/// Identifies.
///
/// # Errors
/// A log that is too short, signs that contradict each other, and quantities that no robot has.
pub fn identify(log: &Log, options: &Options) -> Result<Identified, IdentifyError> {
    let length_s = log.t[log.t.len() - 1] - log.t[0];
    if length_s < SHORTEST_LOG_S {
        return Err(IdentifyError::Short(length_s));
    }
    rows::check(log)?;
    let lengths = rows::lengths(log);
    let missing = rows::missing(log, &lengths);
    let speeds = stretches::speeds(log, stretches::HALF_S);
    let stretches = |limited: &[bool]| {
        stretches::stretches(log, &speeds, options.slow_rad_s, limited, &missing)
    };
    let mut used = stretches(&[]);
    let mut limited = Vec::new();
    // Twice: rows at the limit hide how much current a command makes.
    for _ in 0..2 {
        limited = start::limited(log, &used, options.known.current_limit_a);
        if limited.contains(&true) {
            used = stretches(&limited);
        }
    }
    let poses = kinematics::kinematics(log, options.latency_s, &missing);
    let (motion, train) = dynamics::dynamics(log, &options.known, &speeds, &used, &limited).unzip();
    if let Some(fit) = &poses {
        if fit.sigma[1] > kinematics::ANY_HEADING_RAD {
            return Err(IdentifyError::Headings {
                off_rad: fit.sigma[1],
            });
        }
        for (i, side) in SIDES.into_iter().enumerate() {
            // Not by chance: three standard deviations.
            if fit.value[i] < 0.0 && fit.value[i].powi(2) * fit.information[(i, i)] > 9.0 {
                return Err(IdentifyError::Backwards(side));
            }
        }
        if fit.is_negative(2) {
            return Err(IdentifyError::Mirrored);
        }
    }
    if let Some(fit) = &motion {
        for (side, i) in SIDES.into_iter().zip([0, 3]) {
            if fit.value[i] < 0.0 && fit.value[i].powi(2) * fit.information[(i, i)] > 9.0 {
                return Err(IdentifyError::Against(side));
            }
        }
    }
    // Of commands or voltages that are not those that acted, motion determines nothing.
    let spoilt =
        rows::lost(log, &lengths).or_else(|| train.as_ref().and_then(|train| train.spoilt(log)));
    let motion = motion.filter(|_| spoilt.is_none());
    let given = Given {
        drive: log.drive,
        poses: !log.fixes.is_empty(),
        currents: log.current.is_some(),
        known: options.known.clone(),
    };
    let combined = combine::combine(&given, poses.as_ref(), motion.as_ref());
    let driven = verdict::Driven::new(log, options, &speeds, &used, &missing, spoilt);
    let mut found = verdict::judge(
        &given,
        &combined,
        &driven,
        poses.as_ref(),
        motion.as_ref().zip(train.as_ref()),
    );
    found.plausible()?;
    found.can_be(log)?;
    found.warnings.extend(rows::warning(log, &missing));
    Ok(found)
}
