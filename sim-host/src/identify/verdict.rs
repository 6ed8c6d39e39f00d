//! What is said of each quantity.

use super::combine::Combined;
use super::drivetrain::Found;
use super::fit::Fit;
use super::kinematics::WINDOW_S;
use super::log::{Drive, Log};
use super::products::combinations;
use super::quantity::Quantity;
use super::stretches::{FEWEST, LONGEST_S, SHORTEST_S, Stretch};
use super::structure::Given;
use super::{Entry, Identified, Options, VAGUE, Verdict};
use crate::numbers::digits;
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// Friction is identified, too, where its interval is below this part of all damping: "nearly none"
/// is an answer.
const SMALL: f64 = 0.1;
/// Sums of squares as large as found by chance in one of so many logs are not the model's fault.
const CHANCE: f64 = 1.0e-4;
/// Wheel motion less than this part of the other kind was not driven.
const HARDLY: f64 = 0.1;

/// Of rows further apart no stretch has enough: no log that shows a motor has such ones, and one in ms always \[s\].
const LONGEST_PERIOD_S: f64 = LONGEST_S / FEWEST as f64;

/// What was driven, to say what was not.
pub(super) struct Driven {
    /// Root mean squares of the wheels' common speed and of half their difference \[rad/s\].
    together: f64,
    apart: f64,
    slow_rad_s: f64,
    stretches: usize,
    /// Whether rows are missing.
    gaps: bool,
    step_rad: Option<f64>,
    /// From row to row, on average \[s\].
    period_s: f64,
    /// Why the motion determines nothing.
    spoilt: Option<&'static str>,
}

impl Driven {
    pub(super) fn new(
        log: &Log,
        options: &Options,
        speeds: &[[f64; 2]],
        used: &[Stretch],
        missing: &[bool],
        spoilt: Option<&'static str>,
    ) -> Self {
        let mean = |of: fn(&[f64; 2]) -> f64| {
            (speeds.iter().map(|s| of(s).powi(2)).sum::<f64>() / speeds.len() as f64).sqrt()
        };
        Self {
            together: mean(|s| 0.5 * (s[0] + s[1])),
            apart: mean(|s| 0.5 * (s[0] - s[1])),
            slow_rad_s: options.slow_rad_s,
            stretches: used.len(),
            gaps: missing.contains(&true),
            step_rad: log.step_rad,
            period_s: (log.t[log.t.len() - 1] - log.t[0]) / (log.t.len() - 1) as f64,
            spoilt,
        }
    }

    fn why(&self, quantity: Quantity, spread: Option<f64>, hidden: Option<&str>) -> String {
        use Quantity as Q;
        let lengths = matches!(quantity, Q::RadiusRight | Q::RadiusLeft | Q::Track);
        if self.together + self.apart < 0.1 * self.slow_rad_s {
            return if self.period_s > LONGEST_PERIOD_S {
                let period = digits(self.period_s);
                format!(
                    "the wheels hardly ever turned, and rows are {period} s apart: is `t` in s?"
                )
            } else {
                "the wheels hardly ever turned".to_owned()
            };
        }
        if self.stretches == 0 && !lengths {
            return format!(
                "no stretch of {SHORTEST_S} s in which both wheels turn faster than {} rad/s \
                 without reversing{}",
                self.slow_rad_s,
                if self.gaps {
                    ", and no row is missing"
                } else {
                    ""
                }
            );
        }
        if matches!(quantity, Q::Track | Q::Inertia) && self.apart < HARDLY * self.together {
            return "the wheels hardly ever turned at different rates".to_owned();
        }
        if matches!(quantity, Q::RadiusRight | Q::RadiusLeft | Q::Mass)
            && self.together < HARDLY * self.apart
        {
            return "the robot hardly ever drove forward or backward".to_owned();
        }
        if let (Some(hidden), false) = (hidden, lengths) {
            return hidden.to_owned();
        }
        match spread {
            Some(spread) if spread < 3.0 => format!(
                "what was driven leaves it uncertain by {:.0} %",
                100.0 * spread
            ),
            _ => "what was driven does not show it".to_owned(),
        }
    }
}

pub(super) fn judge(
    given: &Given,
    found: &Combined,
    driven: &Driven,
    poses: Option<&Fit>,
    motion: Option<(&Fit, &Found)>,
) -> Identified {
    let (motion, train) = motion.unzip();
    let fits = [poses, motion];
    let freedom = fits.iter().flatten().map(|fit| fit.freedom);
    let quantile = quantile(freedom.fold(1.0e6, |least, f| if f < least { f } else { least }));
    let determined = given.determined();
    let hidden = train.and_then(|train| train.hidden(quantile));
    let hidden = driven.spoilt.or(hidden);
    let mut quantities = Vec::new();
    for quantity in Quantity::ALL {
        let verdict = match given.known.get(quantity) {
            Some(value) => Verdict::Stated { value },
            None if given.is_given(quantity) => continue,
            None if determined[quantity.index()] => {
                numeric(found, driven, quantity, quantile, hidden)
            }
            None => Verdict::NotIdentifiable {
                why: lacking(given),
                would_help: help(given, quantity),
            },
        };
        quantities.push(Entry::new(
            quantity.name(),
            quantity.unit(),
            quantity.meaning(),
            verdict,
        ));
    }
    let mut combinations = combinations(given, found, quantile, &mut quantities);
    combinations.extend(train.into_iter().flat_map(|train| train.entries(quantile)));
    let mut warnings = warnings(found, driven, motion);
    warnings.extend(train.and_then(Found::warning));
    Identified {
        quantities,
        combinations,
        warnings,
        stretches: driven.stretches,
        pose_windows: poses.map_or(0, |fit| fit.windows),
    }
}

/// 97.5 % of Student's distribution: 1.96 for the thousands of residuals of an ordinary log.
fn quantile(freedom: f64) -> f64 {
    match StudentsT::new(0.0, 1.0, freedom.max(1.0)) {
        Ok(student) => student.inverse_cdf(0.975),
        // Not for a freedom of at least 1; the widest there is.
        Err(_) => 12.706,
    }
}

/// Friction whose whole interval is below 0. Less than its interval below, what was found may be none.
pub(in crate::identify) fn pushes(value: f64, half_width: f64) -> bool {
    value + half_width < 0.0
}

fn numeric(
    found: &Combined,
    driven: &Driven,
    quantity: Quantity,
    quantile: f64,
    hidden: Option<&str>,
) -> Verdict {
    let i = quantity.index();
    let value = found.chart.value(quantity, found.x[i]);
    let wide = quantile * found.covariance[(i, i)].max(0.0).sqrt();
    let (half_width, sharp) = if quantity.is_friction() {
        let half_width = wide * found.chart.unit(quantity);
        let relative = half_width <= VAGUE * value.abs();
        (half_width, relative || wide <= SMALL)
    } else {
        (wide * value, wide <= VAGUE)
    };
    let pushes = quantity.is_friction() && pushes(value, half_width);
    if sharp && !pushes {
        return Verdict::Identified { value, half_width };
    }
    let spread = (!quantity.is_friction()).then_some(wide);
    Verdict::NotIdentifiable {
        why: match pushes {
            true => format!(
                "{value:.2e} ± {half_width:.1e} {} came out, and friction does not push: what is commanded is not all of the torque, as where \
                 a firmware makes up for friction",
                quantity.unit()
            ),
            false => driven.why(quantity, spread, hidden),
        },
        would_help: vec![
            "the drive that docs/identify.md recommends".to_owned(),
            format!("--known {}=...", quantity.name()),
        ],
    }
}

fn lacking(given: &Given) -> String {
    let mut has = vec![match given.drive {
        Drive::Torque => "torques",
        Drive::Voltage => "voltages",
        Drive::Duty => "duties",
    }];
    has.push("wheel angles");
    if given.currents {
        has.push("currents");
    }
    if given.poses {
        has.push("poses");
    }
    format!("{} and what is stated do not determine it", has.join(", "))
}

fn help(given: &Given, quantity: Quantity) -> Vec<String> {
    let mut ways = given.advice(quantity);
    // Three ways are enough to choose from; the first are the columns.
    ways.truncate(3);
    ways.push(format!("--known {}=...", quantity.name()));
    ways
}

fn warnings(found: &Combined, driven: &Driven, motion: Option<&Fit>) -> Vec<String> {
    let mut all = Vec::new();
    if found.freedom > 0
        && let Ok(chance) = ChiSquared::new(found.freedom as f64)
        && chance.sf(found.misfit) < CHANCE
    {
        all.push(format!(
            "the fits and what is stated contradict each other (sum of squares {:.0}, {} expected): \
             a stated value, a sign or a scale is wrong, or the robot is not of this model",
            found.misfit, found.freedom
        ));
    }
    if let (Some(step), Some(fit)) = (driven.step_rad, motion)
        && let Some(&sigma) = fit.sigma.first()
        && sigma > 3.0 * step / 12.0_f64.sqrt()
    {
        all.push(format!(
            "wheel angles are {:.1} counts off the model, where rounding to counts gives 0.3: slip, \
             backlash or a load that the model does not have (windows of {WINDOW_S} s and the \
             intervals allow for it)",
            sigma / step
        ));
    }
    all
}
