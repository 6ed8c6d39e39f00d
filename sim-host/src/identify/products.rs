//! Ratios and products that are known although their parts are not, and the motors' own constants.

use super::combine::Combined;
use super::quantity::{COUNT, Quantity};
use super::structure::Given;
use super::{Entry, VAGUE, Verdict};
use nalgebra::DVector;

type Powers = &'static [(Quantity, f64)];

/// Products of powers that wheels and commands determine without lengths or motor constants.
const PRODUCTS: [(&str, &str, &str, Powers); 6] = {
    use Quantity as Q;
    [
        (
            "radius_right / radius_left",
            "1",
            "how much the robot veers with equal wheel rates",
            &[(Q::RadiusRight, 1.0), (Q::RadiusLeft, -1.0)],
        ),
        (
            "radius_right / track",
            "1",
            "turn per wheel angle",
            &[(Q::RadiusRight, 1.0), (Q::Track, -1.0)],
        ),
        (
            "mass radius_right radius_left",
            "kg m^2",
            "the mass as the wheels feel it",
            &[(Q::Mass, 1.0), (Q::RadiusRight, 1.0), (Q::RadiusLeft, 1.0)],
        ),
        (
            "inertia / (mass track^2)",
            "1",
            "ease of turning against ease of driving",
            &[(Q::Inertia, 1.0), (Q::Mass, -1.0), (Q::Track, -2.0)],
        ),
        (
            "mass radius_right radius_left resistance_right / motor_constant_right",
            "V s^2",
            "voltage per wheel acceleration",
            &[
                (Q::Mass, 1.0),
                (Q::RadiusRight, 1.0),
                (Q::RadiusLeft, 1.0),
                (Q::ResistanceRight, 1.0),
                (Q::MotorConstantRight, -1.0),
            ],
        ),
        (
            "motor_constant_right / resistance_right",
            "N m/V",
            "stall torque per volt",
            &[(Q::MotorConstantRight, 1.0), (Q::ResistanceRight, -1.0)],
        ),
    ]
};

/// Those products whose parts are not all known. The motor's own constant is one of them if the gear
/// is stated.
pub(super) fn combinations(
    given: &Given,
    found: &Combined,
    quantile: f64,
    quantities: &mut Vec<Entry>,
) -> Vec<Entry> {
    let unknown = |q: Quantity, list: &[Entry]| {
        let of = list.iter().find(|e| e.name == q.name());
        of.is_some_and(|e| matches!(e.verdict, Verdict::NotIdentifiable { .. }))
    };
    let mut all = Vec::new();
    for (name, unit, meaning, powers) in PRODUCTS {
        if !powers.iter().any(|(q, _)| unknown(*q, quantities)) {
            continue;
        }
        let mut by = DVector::zeros(COUNT);
        let mut log = 0.0;
        for (quantity, power) in powers {
            by[quantity.index()] = *power;
            log += power * found.x[quantity.index()];
        }
        let wide = quantile * by.dot(&(&found.covariance * &by)).max(0.0).sqrt();
        if wide <= VAGUE {
            let verdict = Verdict::Identified {
                value: log.exp(),
                half_width: wide * log.exp(),
            };
            all.push(Entry::new(name, unit, meaning, verdict));
        }
    }
    if let Some(gear) = given.known.gear {
        own_constants(gear, quantities);
    }
    all
}

/// The motors' own constants behind a stated gear.
fn own_constants(gear: f64, quantities: &mut Vec<Entry>) {
    let sides = [
        ("torque_constant_right", Quantity::MotorConstantRight),
        ("torque_constant_left", Quantity::MotorConstantLeft),
    ];
    for (name, of) in sides {
        let Some(wheel) = quantities.iter().find(|e| e.name == of.name()) else {
            continue;
        };
        let verdict = match wheel.verdict.clone() {
            Verdict::Stated { value } => Verdict::Stated {
                value: value / gear,
            },
            Verdict::Identified { value, half_width } => Verdict::Identified {
                value: value / gear,
                half_width: half_width / gear,
            },
            not => not,
        };
        let meaning = "of the motor itself, before the gear";
        quantities.push(Entry::new(name, of.unit(), meaning, verdict));
    }
}
