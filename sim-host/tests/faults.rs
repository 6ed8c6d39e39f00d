//! The fault campaign: quiet with the base as it is, loud with one that is broken on purpose.

use controller_core::safety::{FaultKind, PolicyParams, Reaction, Response};
use sim_host::campaign::{Bases, Mutation, Outcome, Target, UpsetKind, cells, study, violation};
use std::collections::BTreeSet;

/// Every trouble in every state on every base, once.
const ALL: u64 = (UpsetKind::ALL.len() * Target::ALL.len() * 3) as u64;

fn bases() -> Bases {
    Bases::built_in().expect("built in")
}

fn broken(outcomes: &[Outcome]) -> Vec<String> {
    outcomes.iter().filter_map(violation).collect()
}

#[test]
fn every_trouble_in_every_state_is_ridden_out_or_stopped_in_time() {
    let outcomes = study(&bases(), 2, 0..ALL, &Mutation::None, || {}).expect("valid");
    assert!(outcomes.len() >= 500);
    let violations = broken(&outcomes);
    assert!(violations.is_empty(), "{}", violations.join("\n"));
    let hit: BTreeSet<_> = outcomes.iter().map(|o| (o.upset, o.target)).collect();
    assert_eq!(hit.len(), UpsetKind::ALL.len() * Target::ALL.len());
    // The bounds are about what happens, not beyond it: some stop uses more than half of its own.
    let cells = cells(&outcomes, None);
    let most = cells
        .iter()
        .map(|cell| cell.stop.share())
        .fold(0.0, f64::max);
    assert!(most > 0.5, "{most}");
    // Nothing at all is never stopped by what only trouble explains.
    for outcome in &outcomes {
        if outcome.upset == UpsetKind::Nothing && outcome.second.is_none() {
            assert!(outcome.found.is_none(), "{outcome:?}");
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("threads");
        pool.install(|| study(&bases(), 3, 0..24, &Mutation::None, || {}).expect("valid"))
    };
    assert_eq!(run(1), run(4));
}

/// A driver that goes on with the last torque, and a brake that is not connected: only what truly happens
/// tells, for the base itself says what it should.
#[test]
fn drivers_that_do_not_do_what_they_are_told_are_found_out() {
    for mutation in [Mutation::KeepsTorque, Mutation::BrakeCoasts] {
        let outcomes = study(&bases(), 2, 0..ALL / 3, &mutation, || {}).expect("valid");
        let far = broken(&outcomes)
            .iter()
            .filter(|text| text.contains("beyond"))
            .count();
        // Braking from speed is in a ninth of the runs, and more stop by it.
        assert!(far > 10, "{mutation:?}: {far}");
    }
}

/// What a policy may leave out but should not: the campaign has its own list.
#[test]
fn a_policy_that_rides_out_a_silent_host_is_found_out() {
    let policy = PolicyParams::DEFAULT.with(FaultKind::CommandStale, Response::RIDE_OUT);
    let mutation = Mutation::Policy(policy);
    let outcomes = study(&bases(), 2, 0..ALL / 3, &mutation, || {}).expect("valid");
    let ridden = broken(&outcomes)
        .iter()
        .filter(|text| text.contains("command_stale was found"))
        .count();
    // Armed, tracking, parking and parked.
    assert!(ridden >= 4, "{ridden}");
}

#[test]
fn a_policy_that_rides_out_a_stuck_encoder_is_refused() {
    let stuck = FaultKind::EncoderStuck;
    let policy = PolicyParams::DEFAULT;
    for reaction in [Reaction::RideOut, Reaction::ControlledStop] {
        let policy = policy.with(stuck, Response::passing(reaction));
        let mutation = Mutation::Policy(policy);
        assert!(study(&bases(), 1, 0..1, &mutation, || {}).is_err());
    }
}

/// The table of stopping distances in the document is what the core's functions give.
#[test]
fn the_document_has_the_stopping_distances_of_the_core() {
    use controller_core::maths::Single;
    use controller_core::motor::{coast, electrical_brake};
    use controller_core::safety::controlled_stop_distance;
    use sim_host::campaign::Plan;
    use sim_host::rig::Rig;
    use sim_host::scenario::BASES;

    let document = include_str!("../../docs/faults.md");
    let mut missing = 0;
    for built_in in BASES {
        let name = built_in.name;
        let base = built_in.base().expect("valid");
        let plan = Plan::draw(&bases(), 1, 0);
        let rig = Rig::of_base(&base, &plan.place, |_| {}).expect("valid");
        let core = rig.base().base();
        let robot = core.motion().params().robot;
        let motor = core.motor().expect("has motors");
        let speed = base.limits.speed as f32;
        let controlled = controlled_stop_distance::<f32, Single>(core.motion(), speed);
        let brake = electrical_brake(motor, &robot).expect("valid").linear;
        let brake = brake.distance(speed).expect("brakes");
        let release = coast(motor, &robot).expect("valid").linear;
        let release = release.distance(speed).expect("has friction");
        // c: what a wheel brakes with at the driver's limit.
        let own = base.hardware.expect("has hardware").motor;
        let torque = own.gear_ratio * own.kt_nm_per_a * own.current_limit_a;
        let most = torque / base.robot.wheels.radius_right_m;
        let limited =
            f64::from(brake) + 0.25 * base.limits.speed.powi(2) * base.robot.mass_kg / most;
        let row = format!(
            "| {name} | {speed:.1} m/s | {controlled:.2} m | {brake:.3} m | {limited:.3} m | {release:.2} m |"
        );
        println!("{row}");
        missing += usize::from(!document.contains(&row));
    }
    assert_eq!(missing, 0, "rows above that docs/faults.md does not have");
}
