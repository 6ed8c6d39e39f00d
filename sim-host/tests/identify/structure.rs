//! What each kind of log determines: the table of `docs/identify.md`, line by line.

use Quantity as Q;
use sim_host::identify::{Drive, Given, Known, Quantity};

const LENGTHS: [Quantity; 3] = [Q::RadiusRight, Q::RadiusLeft, Q::Track];
const MOTORS: [Quantity; 4] = [
    Q::MotorConstantRight,
    Q::MotorConstantLeft,
    Q::ResistanceRight,
    Q::ResistanceLeft,
];
const VISCOUS: [Quantity; 2] = [Q::ViscousRight, Q::ViscousLeft];
const COULOMB: [Quantity; 2] = [Q::CoulombRight, Q::CoulombLeft];
const BODY: [Quantity; 2] = [Q::Mass, Q::Inertia];

fn given(drive: Drive, poses: bool, currents: bool, known: &str) -> Given {
    let mut stated = Known::default();
    if !known.is_empty() {
        stated.state(known).expect("known names");
    }
    Given {
        drive,
        poses,
        currents,
        known: stated,
    }
}

/// Exactly these, beside what is stated.
fn determines(given: &Given, groups: &[&[Quantity]]) {
    let determined = given.determined();
    for quantity in LENGTHS
        .iter()
        .chain(&MOTORS)
        .chain(&VISCOUS)
        .chain(&COULOMB)
        .chain(&BODY)
    {
        let expected = groups.iter().any(|group| group.contains(quantity))
            || given.known.get(*quantity).is_some();
        let name = quantity.name();
        assert_eq!(
            determined[*quantity as usize], expected,
            "{name} with {given:?}"
        );
    }
}

#[test]
fn the_table_of_the_documentation_holds() {
    use Drive::{Duty, Torque, Voltage};
    for drive in [Duty, Voltage] {
        determines(&given(drive, false, false, ""), &[]);
        determines(&given(drive, true, false, ""), &[&LENGTHS]);
        for known in ["mass=10", "inertia=0.3"] {
            determines(
                &given(drive, true, false, known),
                &[&LENGTHS, &COULOMB, &BODY],
            );
        }
    }
    determines(
        &given(Voltage, false, true, ""),
        &[&MOTORS, &VISCOUS, &COULOMB],
    );
    determines(
        &given(Voltage, true, true, ""),
        &[&LENGTHS, &MOTORS, &VISCOUS, &COULOMB, &BODY],
    );
    determines(&given(Torque, false, false, ""), &[&VISCOUS, &COULOMB]);
    determines(
        &given(Torque, true, false, ""),
        &[&LENGTHS, &VISCOUS, &COULOMB, &BODY],
    );
}

#[test]
fn the_supply_of_duties_counts() {
    // Current and duty: the back-EMF in duty, the torque in amperes; one voltage sets both.
    let all: &[&[Quantity]] = &[&LENGTHS, &MOTORS, &VISCOUS, &COULOMB, &BODY];
    determines(&given(Drive::Duty, true, true, "supply=12"), all);
    let unknown = given(Drive::Duty, true, true, "");
    assert!(!unknown.determined()[Q::Mass as usize]);
    let advice = unknown.advice(Q::Mass);
    assert!(
        advice.iter().any(|way| way.contains("column supply")),
        "{advice:?}"
    );
}

/// Advice is taken and checked: what it names determines the quantity.
#[test]
fn advice_names_what_is_missing() {
    let nothing = given(Drive::Voltage, false, false, "");
    let lengths = nothing.advice(Q::Track);
    assert!(
        lengths.iter().any(|way| way.contains("pose")),
        "{lengths:?}"
    );
    // Neither poses nor currents alone give a mass; both together do.
    let mass = nothing.advice(Q::Mass);
    assert!(
        mass.iter()
            .any(|way| way.contains("pose") && way.contains("currents")),
        "{mass:?}"
    );
    let with_poses = given(Drive::Voltage, true, false, "");
    let mass = with_poses.advice(Q::Mass);
    assert!(
        mass.iter().any(|way| way.contains("current_right")),
        "{mass:?}"
    );
    assert!(mass.iter().any(|way| way.contains("inertia")), "{mass:?}");
}
