//! What was identified, as keys of a base's file.
//!
//! A base's file says with its own numbers what a log shows at the wheels. With gear ratio n
//! (`gear_ratio`), `kt_nm_per_a` K, `strength` s, rotor inertia J_m (`rotor_inertia_kg_m2`), and the
//! wheel inertia J that was stated (0 if none was):
//!
//! | identified | keys | because |
//! | --- | --- | --- |
//! | `motor_constant` k per side | K = (k_R + k_L)/2n, s = k/nK | the torque at a wheel is n s K per ampere, its back-EMF n s K per speed |
//! | `resistance` | `resistance_ohm`, mean | both motors have one key |
//! | `mass` | m + 2 (J - n^2 J_m)/r^2 | `[robot] m` holds the wheels' turning but not the rotors', which `[motor]` has |
//! | `inertia` | I + (J - n^2 J_m) l^2/(2 r^2) | the same |
//! | `viscous`, `coulomb` | means | at the wheel, both |
//! | `supply` | `nominal_v`, if identified | it is the voltage of full duty, which a controller that does not measure it must assume; a stated one is no finding |
//! | `efficiency`, `dead_band` | `gear_efficiency`, `dead_band`: means, within 0 to 1 | both motors have one key |
//!
//! The sums in m and I leave the inertia that the wheels see as it is: with r^2 = r_R r_L,
//! r^2 (m/4 + I/l^2) + J and m/4 - I/l^2 are the same on both sides.
//!
//! Logs of torques, and those that do not show a motor braking, do not show the efficiency. With torques at the motor, before the
//! gear, a share e arrives when the motor drives (2 - e when it is driven), so mass, inertia and friction come out too
//! large by 1/e to 1/(2 - e). Then a file with a smaller efficiency than 1 gets a note.

mod document;
mod hardware;

use super::{Identified, Quantity, Verdict};
use Quantity as Q;
use document::{Document, rounded};

/// A file, updated.
#[derive(Clone, Debug, PartialEq)]
pub struct Updated {
    /// All of it.
    pub text: String,
    /// What one should know about it: means of unlike sides, values that were not written, keys that
    /// had to follow.
    pub notes: Vec<String>,
}

/// Why a file cannot be updated.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// Not TOML.
    #[error("not TOML: {0}")]
    Toml(#[from] toml_edit::TomlError),
    /// A name of a table stands for something else.
    #[error("`{0}` is not a table")]
    NotATable(&'static str),
}

/// Writes what was identified or stated into a base's file, under the keys that [`Base::load`]
/// knows, and leaves everything else in it as it is, comments too. What was neither identified nor
/// stated gets no key; what stands there stays. `gear` is the stated gear ratio.
///
/// A file of a base without motors gets no motors: half of their keys would be refused.
///
/// # Errors
/// Text that is not TOML, or of other tables.
///
/// [`Base::load`]: crate::mission::BaseSpec::load
pub fn update(text: &str, found: &Identified, gear: Option<f64>) -> Result<Updated, ProfileError> {
    let mut update = Update {
        file: Document::parse(text)?,
        found,
        notes: Vec::new(),
    };
    // First the gear, which the body's inertia needs.
    update.hardware(gear);
    update.radii();
    if let Some(track) = update.estimate(Q::Track) {
        update.file.set("robot", "l", track.value);
    }
    update.body();
    Ok(Updated {
        text: update.file.text(),
        notes: update.notes,
    })
}

/// Whether a file can be updated.
///
/// # Errors
/// As of [`update`].
pub fn check(text: &str) -> Result<(), ProfileError> {
    Document::parse(text).map(drop)
}

/// Counts of a whole turn of a wheel, if this base's file says so.
pub fn counts_per_turn(text: &str) -> Option<f64> {
    positive(text, "encoder", "counts_per_turn")
}

fn positive(text: &str, table: &str, key: &str) -> Option<f64> {
    let number = Document::parse(text).ok()?.number(table, key)?;
    (number.is_finite() && number > 0.0).then_some(number)
}

/// Current at which the drivers of this base's file hold a motor, if it says so \[A\].
pub fn current_limit_a(text: &str) -> Option<f64> {
    positive(text, "motor", "current_limit_a")
}

/// A value and half of its 95 % interval, 0 for a stated one.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    value: f64,
    half_width: f64,
}

struct Update<'a> {
    file: Document,
    found: &'a Identified,
    notes: Vec<String>,
}

impl Update<'_> {
    fn estimate(&self, quantity: Quantity) -> Option<Estimate> {
        let (value, half_width) = match self.found.of(quantity)? {
            Verdict::Stated { value } => (*value, 0.0),
            Verdict::Identified { value, half_width } => (*value, *half_width),
            Verdict::NotIdentifiable { .. } => return None,
        };
        Some(Estimate { value, half_width })
    }

    /// An estimate of one side that is none of the quantities, by its name.
    fn side_estimate(&self, name: &str) -> Option<Estimate> {
        let mut entries = self.found.combinations.iter();
        match entries.find(|entry| entry.name == name)?.verdict {
            Verdict::Identified { value, half_width } => Some(Estimate { value, half_width }),
            _ => None,
        }
    }

    /// Both sides of what has one key.
    fn both(&mut self, key: &str, right: Quantity, left: Quantity) -> Option<[Estimate; 2]> {
        let sides = [right, left].map(|side| self.estimate(side));
        self.pair(key, sides)
    }

    fn pair(&mut self, key: &str, sides: [Option<Estimate>; 2]) -> Option<[Estimate; 2]> {
        if let [Some(_), None] | [None, Some(_)] = sides {
            self.notes
                .push(format!("{key} is left as it was: one side alone is known"));
        }
        let [right, left] = sides;
        Some([right?, left?])
    }

    /// Their mean, with a note if they differ.
    fn mean(&mut self, key: &str, right: Quantity, left: Quantity) -> Option<Estimate> {
        let sides = self.both(key, right, left)?;
        Some(self.mean_of(key, sides))
    }

    fn mean_of(&mut self, key: &str, [r, l]: [Estimate; 2]) -> Estimate {
        // Of the difference of two independent estimates; each side has its own noise.
        let both = r.half_width.hypot(l.half_width);
        if (r.value - l.value).abs() > both {
            self.notes.push(format!(
                "{key} is the mean of both sides, which differ by more than their intervals: right \
                 {:.4} ± {:.4}, left {:.4} ± {:.4}",
                r.value, r.half_width, l.value, l.half_width
            ));
        }
        Estimate {
            value: 0.5 * (r.value + l.value),
            half_width: 0.5 * both,
        }
    }

    /// Both radii by `r` if they are equal and nothing speaks for a pair, never by both ways.
    fn radii(&mut self) {
        let Some([right, left]) = self.both("[robot] r", Q::RadiusRight, Q::RadiusLeft) else {
            return;
        };
        let pair = ["r_right", "r_left"];
        let has_pair = pair.iter().any(|key| self.file.has("robot", key));
        let equal = rounded(right.value) == rounded(left.value);
        if equal && (self.file.has("robot", "r") || !has_pair) {
            self.file.set("robot", "r", right.value);
            for key in pair {
                self.file.remove("robot", key);
            }
            return;
        }
        if has_pair {
            self.file.remove("robot", "r");
        } else {
            self.file.rename("robot", "r", "r_right");
        }
        self.file.set("robot", "r_right", right.value);
        self.file.set("robot", "r_left", left.value);
    }

    /// Mass and inertia, with the wheels' turning but not the rotors'.
    fn body(&mut self) {
        let of_wheels = self.estimate(Q::WheelInertia).map_or(0.0, |j| j.value);
        let motor = |key| self.file.number("motor", key);
        let of_rotors = match (motor("gear_ratio"), motor("rotor_inertia_kg_m2")) {
            (Some(gear), Some(rotor)) => gear * gear * rotor,
            _ => 0.0,
        };
        let turning = of_wheels - of_rotors;
        let robot = |key| self.file.number("robot", key);
        let radii = ["r_right", "r_left"].map(|key| robot(key).or(robot("r")));
        let lengths = match (radii, robot("l")) {
            ([Some(right), Some(left)], Some(track)) => Some((right * left, track)),
            _ => None,
        };
        let per_mass = lengths.map(|(r2, _)| 2.0 * turning / r2);
        let per_inertia = lengths.map(|(r2, track)| 0.5 * turning * track * track / r2);
        for (key, quantity, more) in [("m", Q::Mass, per_mass), ("I", Q::Inertia, per_inertia)] {
            let Some(estimate) = self.estimate(quantity) else {
                continue;
            };
            let more = if turning == 0.0 { Some(0.0) } else { more };
            let Some(more) = more else {
                self.notes.push(format!(
                    "[robot] {key} is left as it was: without radii and track the part of wheels \
                     and rotors is not known"
                ));
                continue;
            };
            let value = estimate.value + more;
            if value <= 0.0 {
                self.notes.push(format!(
                    "[robot] {key} is left as it was: rotors of {of_rotors:.3e} kg m^2 each at the \
                     wheel are more than all that was found; check rotor_inertia_kg_m2 and gear_ratio"
                ));
                continue;
            }
            if more != 0.0 {
                self.notes.push(format!(
                    "[robot] {key} is {:.4} with {more:+.4}: it holds the wheels' turning but not \
                     the rotors', which [motor] has",
                    estimate.value
                ));
            }
            self.file.set("robot", key, value);
        }
    }
}
