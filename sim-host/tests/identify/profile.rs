//! What is written into a base's file.

use crate::round_trip::LAB;
use Quantity as Q;
use sim_host::identify::profile::{ProfileError, Updated, update};
use sim_host::identify::{Entry, Identified, Quantity, Verdict};
use sim_host::mission::BaseSpec;

fn found(entries: &[(Quantity, f64, f64)]) -> Identified {
    let entry = |&(quantity, value, half_width): &(Quantity, f64, f64)| Entry {
        name: quantity.name().to_owned(),
        unit: quantity.unit(),
        meaning: quantity.meaning(),
        verdict: match half_width {
            0.0 => Verdict::Stated { value },
            _ => Verdict::Identified { value, half_width },
        },
    };
    Identified {
        quantities: entries.iter().map(entry).collect(),
        combinations: Vec::new(),
        warnings: Vec::new(),
        stretches: 1,
        pose_windows: 1,
    }
}

fn updated(text: &str, entries: &[(Quantity, f64, f64)]) -> (Updated, BaseSpec) {
    let updated = update(text, &found(entries), None).expect("TOML");
    let base = BaseSpec::parse("robot.toml", &updated.text);
    let base = base.unwrap_or_else(|error| panic!("{error}\n{}", updated.text));
    (updated, base)
}

fn says(notes: &[String], parts: &[&str]) {
    let said = |note: &&String| parts.iter().all(|part| note.contains(part));
    assert!(notes.iter().any(|n| said(&n)), "{parts:?} in {notes:?}");
}

#[test]
fn what_is_not_identified_stays() {
    let (updated, _) = updated(LAB, &[]);
    assert_eq!(updated.text, LAB);
    assert!(updated.notes.is_empty(), "{:?}", updated.notes);
}

#[test]
fn radii_are_a_pair_or_one() {
    let pair = [(Q::RadiusRight, 0.076, 1e-4), (Q::RadiusLeft, 0.074, 1e-4)];
    let (first, base) = updated(LAB, &pair);
    assert_eq!(base.robot.wheels.radius_right_m, 0.076);
    assert_eq!(base.robot.wheels.radius_left_m, 0.074);
    // In its place, between I and l.
    let place = |key| first.text.find(key).expect("a key");
    assert!(place("\nI =") < place("\nr_right") && place("\nr_right") < place("\nl ="));
    // The other way a file with a pair stays one, and a file with r keeps r.
    let equal = [(Q::RadiusRight, 0.08, 0.0), (Q::RadiusLeft, 0.08, 0.0)];
    for text in [LAB, &first.text] {
        let (_, base) = updated(text, &equal);
        assert_eq!(base.robot.wheels.radius_right_m, 0.08);
        assert_eq!(base.robot.wheels.radius_left_m, 0.08);
    }
    // One side of a key for both is no finding.
    let (one, base) = updated(LAB, &pair[..1]);
    assert_eq!(base.robot.wheels.radius_right_m, 0.075);
    says(&one.notes, &["[robot] r ", "one side"]);
}

#[test]
fn sides_with_one_key_get_their_mean_and_a_note() {
    let (alike, base) = updated(
        LAB,
        &[
            (Q::ResistanceRight, 0.9, 0.05),
            (Q::ResistanceLeft, 0.92, 0.05),
        ],
    );
    let hardware = base.hardware.expect("hardware");
    let motor = hardware.drivers.motor().expect("motors");
    assert_eq!(motor.resistance_ohm, 0.91);
    assert!(alike.notes.is_empty(), "{:?}", alike.notes);
    let (unlike, _) = updated(
        LAB,
        &[
            (Q::ResistanceRight, 0.9, 0.05),
            (Q::ResistanceLeft, 1.0, 0.05),
        ],
    );
    says(&unlike.notes, &["resistance_ohm", "mean", "0.9000"]);
}

#[test]
fn friction_that_pushes_is_not_written() {
    let (nearly, base) = updated(
        LAB,
        &[
            (Q::ViscousRight, -1e-4, 2e-4),
            (Q::ViscousLeft, -1e-4, 2e-4),
        ],
    );
    assert_eq!(base.hardware.expect("motors").friction.viscous_nm_s, 0.0);
    says(&nearly.notes, &["viscous_nm_s is 0"]);
    let (surely, base) = updated(
        LAB,
        &[(Q::ViscousRight, -1.0, 0.1), (Q::ViscousLeft, -1.0, 0.1)],
    );
    assert_eq!(base.hardware.expect("motors").friction.viscous_nm_s, 4.0e-3);
    says(&surely.notes, &["viscous_nm_s is left"]);
}

#[test]
fn supply_is_nominal_voltage_only_if_it_was_found() {
    let volts = |entry| {
        let (_, base) = updated(LAB, &[entry]);
        base.hardware.expect("motors").battery.nominal_v
    };
    assert_eq!(volts((Q::Supply, 22.0, 0.5)), 22.0);
    assert_eq!(volts((Q::Supply, 22.0, 0.0)), 24.0);
}

#[test]
fn gear_losses_are_said() {
    let (updated, base) = updated(LAB, &[(Q::Inertia, 0.5, 0.01)]);
    says(&updated.notes, &["gear_efficiency is 0.8", "1/0.8"]);
    // 0.5 less the rotors' 26^2 * 1e-5 * 0.35^2 / (2 * 0.075^2), to the six digits that are written.
    let rotors = 26.0_f64.powi(2) * 1.0e-5 * 0.35_f64.powi(2) / (2.0 * 0.075_f64.powi(2));
    assert!((base.robot.inertia_kg_m2 - (0.5 - rotors)).abs() < 1.0e-6);
}

#[test]
fn losses_that_were_found_are_written() {
    let mut found = found(&[(Q::Inertia, 0.5, 0.01)]);
    for (name, value) in [
        ("efficiency_right", 1.004),
        ("efficiency_left", 1.0),
        ("dead_band_right", 0.024),
        ("dead_band_left", 0.026),
    ] {
        found.combinations.push(Entry {
            name: name.to_owned(),
            unit: "1",
            meaning: "",
            verdict: Verdict::Identified {
                value,
                half_width: 0.01,
            },
        });
    }
    let updated = update(LAB, &found, None).expect("TOML");
    let base = BaseSpec::parse("robot.toml", &updated.text).expect("a base");
    let hardware = base.hardware.expect("hardware");
    let motor = hardware.drivers.motor().expect("motors");
    assert_eq!(motor.gear_efficiency, 1.0);
    assert_eq!(motor.dead_band, 0.025);
    // No gear gives torque back, which is said; nor is there a loss that was not found.
    says(&updated.notes, &["gear_efficiency is 1:", "1.0020"]);
    let lost = updated.notes.iter().any(|n| n.contains("no gear losses"));
    assert!(!lost, "{:?}", updated.notes);
}

#[test]
fn a_base_without_motors_gets_none() {
    let end = LAB.find("[motor]").expect("motors");
    let (updated, base) = updated(
        &LAB[..end],
        &[(Q::CoulombRight, 0.2, 0.01), (Q::CoulombLeft, 0.2, 0.01)],
    );
    assert!(base.hardware.is_none());
    says(&updated.notes, &["no motors"]);
}

#[test]
fn constants_need_the_gear() {
    let entries = [
        (Q::MotorConstantRight, 1.0, 0.01),
        (Q::MotorConstantLeft, 1.2, 0.01),
    ];
    let new = update("", &found(&entries), None).expect("TOML");
    assert!(!new.text.contains("kt_nm_per_a"), "{}", new.text);
    says(&new.notes, &["--known gear"]);
    let new = update("", &found(&entries), Some(20.0)).expect("TOML");
    for part in [
        "gear_ratio = 20.0",
        "kt_nm_per_a = 0.055",
        "strength = [0.909091, 1.09091]",
    ] {
        assert!(new.text.contains(part), "{part} in {}", new.text);
    }
}

#[test]
fn what_is_no_file_of_a_base_is_refused() {
    let none = found(&[]);
    assert!(matches!(
        update("robot = 3", &none, None),
        Err(ProfileError::NotATable("robot"))
    ));
    assert!(matches!(
        update("[robot", &none, None),
        Err(ProfileError::Toml(_))
    ));
}
