//! Rubbish, so many inputs of each kind, the same on every machine; `tests::fuzz` says what, and how to try more.

use std::path::Path;

use tests::fuzz::{Target, base, files, fuzz, inputs, wire};

/// All inputs that once met something new, and so many changed ones.
fn holds(target: &Target) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("corpus")
        .join(target.name);
    let kept = inputs(&folder).expect("readable");
    let outcome = fuzz(target, 20_260_101, kept, |tried| tried < target.in_a_test);
    println!(
        "{}: {} inputs, {} things met",
        target.name, outcome.tried, outcome.met
    );
    if let Some((input, message)) = outcome.failed {
        panic!(
            "{message}\nthe input: {input:?}\n{}",
            String::from_utf8_lossy(&input)
        );
    }
    assert_eq!(outcome.tried, target.in_a_test);
    assert!(outcome.met > 10, "{}", outcome.met);
}

#[test]
fn any_trajectory_file_is_read_or_refused() {
    holds(&files::TRAJECTORY);
}

#[test]
fn any_scenario_is_read_or_refused() {
    holds(&files::SCENARIO);
}

#[test]
fn any_base_file_is_read_or_refused() {
    holds(&files::BASE);
}

#[test]
fn any_bytes_on_the_line_leave_torques_within_the_limit() {
    holds(&wire::LINE);
}

#[test]
fn any_orders_and_measurements_leave_torques_within_the_limit() {
    holds(&base::TICKS);
}
