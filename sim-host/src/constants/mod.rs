//! A robot as constants for a firmware: a Rust file with every parameter of
//! [`controller_core::base::BaseParams`], in the simulator's very numbers.
//!
//! ```
//! use sim_host::constants::rust;
//! use sim_host::scenario::BuiltInBase;
//!
//! let base = BuiltInBase::find("lab-10kg").ok_or("not built in")?.base()?;
//! let text = rust("lab-10kg.toml", &base).map_err(|error| error.to_string())?;
//! assert!(text.contains("pub const BASE: BaseParams<f32>") && text.contains("track_m: 0.35,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod c_header;
mod literal;

use crate::closed_loop;
use crate::mission::BaseSpec;
use crate::numbers::param;
use controller_core::error::ParamError;
use controller_core::motor::DriverParams;

pub use c_header::c_header;
pub use literal::NoLiteral;

/// Words that name nothing in Rust, in C or in C++.
const RESERVED: &str = "abstract alignas alignof and as asm async auto await become bool box break case catch char class const continue crate \
    decltype default delete do double dyn else enum explicit export extern false final float fn for friend gen goto if impl in inline int let long \
    loop macro main match mod move mut mutable namespace new noexcept not nullptr operator or override priv private protected pub public ref register \
    restrict return self short signed sizeof static struct super switch template this thread_local throw trait true try type typedef typeid typename \
    typeof union unsafe unsigned unsized use using virtual void volatile where while xor yield";

/// The module's name: the file's, in what Rust and C take for one.
pub fn module_name(name: &str) -> String {
    let letters = name.chars().map(|c| match c {
        'a'..='z' | '0'..='9' => c,
        'A'..='Z' => c.to_ascii_lowercase(),
        _ => '_',
    });
    let mut name: String = letters.collect();
    let reserved = RESERVED.split(' ').any(|word| word == name);
    // What twb.h names and guards, and what C's own headers keep for types.
    let of_headers = format!("{name}_").starts_with("twb_") || name.ends_with("_t");
    if reserved || of_headers || !name.starts_with(|c: char| c.is_ascii_lowercase()) {
        name.insert_str(0, "robot_");
    }
    name
}

/// The control period \[µs\].
pub fn period_us(base: &BaseSpec) -> u32 {
    (1.0e6 * base.period_s()).round() as u32
}

/// The file: `PERIOD_US` and `BASE`, as rustfmt leaves it, for a module of its own: `mod robot;`, or `include!` in one, which takes no `//!`. `source` is the name of the robot's file.
///
/// # Errors
/// Parameters that the core refuses.
pub fn rust(source: &str, base: &BaseSpec) -> Result<String, ConstantsError> {
    let period_us = period_us(base);
    let params = closed_loop::params(base, period_us)?;
    // A name goes into comments: on one line, and in no sentence, whatever its grammar.
    let name = base.name.replace(['\n', '\r'], " ");
    let driver = match &params.driver {
        DriverParams::Torques => "DriverParams",
        DriverParams::Motors(_) => "{DriverParams, MotorParams, WheelFriction}",
        DriverParams::Speeds(_) => "{DriverParams, SpeedParams}",
    };
    let localiser = params
        .localiser
        .fusion
        .map_or("LocaliserParams", |_| "{FusionParams, LocaliserParams}");
    let gyro = params
        .localiser
        .gyro
        .map_or("", |_| "use controller_core::gyro::GyroParams;\n");
    let jump = params.motion.jump.map_or("", |_| "JumpThreshold, ");
    Ok(format!(
        "\
// Robot constants: {name}
//
// Made by `sim-host constants` from `{source}`: change that file, not this one. SI units, radians; what a field is
// stands at its type.

use controller_core::base::BaseParams;
{gyro}use controller_core::localiser::{localiser};
use controller_core::motion::{{
    Arrival, AtRest, {jump}Limits, MotionGains, MotionParams, Parking, SaturationPolicy,
}};
use controller_core::motor::{driver};
use controller_core::odometry::{{Calibration, OdometryParams}};
use controller_core::robot::Robot;
use controller_core::safety::supervisor::{{Emergency, IdleOutput, RestLimits, SupervisorParams}};
use controller_core::safety::{{
    CurrentDetectorParams, DetectorParams, PolicyParams, Reaction, Response, SlipDetectorParams,
    StuckDetectorParams, SupplyDetectorParams, TickDetectorParams, Timeout, WheelDetectorParams,
}};
use controller_core::wheels::WheelGeometry;

/// Time between ticks \\[µs\\].
pub const PERIOD_US: u32 = {};

/// All parameters: {name}
pub const BASE: BaseParams<f32> = {};
",
        literal::whole(period_us),
        literal::literal(&params)?
    ))
}

/// Why there are no constants.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConstantsError {
    /// A parameter that the core refuses.
    #[error("{}", param(.0))]
    Param(ParamError),
    /// A parameter of a type that has no literal.
    #[error(transparent)]
    Literal(#[from] NoLiteral),
    /// More parameters than a blob holds.
    #[error("the parameters are too long for a blob")]
    TooLong,
}

impl From<ParamError> for ConstantsError {
    fn from(error: ParamError) -> Self {
        Self::Param(error)
    }
}

#[cfg(test)]
mod tests {
    use super::module_name;

    /// What is a name neither in Rust nor in C becomes one of both.
    #[test]
    fn names_are_names_in_both_languages() {
        for (file, name) in [
            ("lab-10kg", "lab_10kg"),
            ("Rover 2", "rover_2"),
            ("2wd", "robot_2wd"),
            ("int", "robot_int"),
            ("match", "robot_match"),
            ("Main", "robot_main"),
            ("twb", "robot_twb"),
            ("twb-base", "robot_twb_base"),
            ("twbot", "twbot"),
            ("uint8_t", "robot_uint8_t"),
        ] {
            assert_eq!(module_name(file), name);
        }
    }
}
