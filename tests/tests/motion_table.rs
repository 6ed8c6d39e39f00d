//! The parking law against the two-way polar law with acceleration neurons, on the same grids: one table.

use controller_core::maths::Libm;
use controller_core::shunting::ExactMean;
use tests::aicardi;
use tests::check::assert_within;
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{hand_over_states, ring};
use tests::motion_parking::{park_all, print, worst};
use tests::tolerance::TWO_DECIMALS;

use crate::motion_parking::{state_hand_over, state_ring};

/// Both laws on the 90 hand-over states and the 1,152 poses of the ring. `--nocapture` prints the table.
#[test]
fn chosen_law_beats_the_two_way_polar_law() {
    let base = Base::STANDARD;
    let motion = base.exact().validate().expect("valid");
    let dt = 0.01;
    let both = |name: &str, starts: &[Body]| {
        let theirs = on_all_cores(starts, |body| aicardi::park(base, *body, dt, 20.0));
        let ours = park_all::<f64, Libm, ExactMean>(&motion, base, starts, dt, 20.0);
        print(&format!("two-way polar law, {name}"), &theirs);
        print(&format!("chosen law, {name}"), &ours);
        (theirs, ours)
    };
    let (theirs, ours) = both("90 states", &hand_over_states());
    state_hand_over("two-way polar law", &theirs);
    let (theirs, ours) = (worst(&theirs).0, worst(&ours).0);
    // An independent reference's figures: 5.9 s, 9 N, 55 N m.
    assert_within(
        theirs.near_s,
        5.89,
        TWO_DECIMALS,
        "time to 1 cm and 0.02 rad",
    );
    assert_within(theirs.moment, 54.8, 0.5, "largest moment");
    assert!(ours.near_s < theirs.near_s && ours.moment < theirs.moment);
    let (theirs, ours) = both("ring", &ring());
    state_ring("two-way polar law", &theirs);
    let (theirs, ours) = (worst(&theirs).0, worst(&ours).0);
    assert_eq!(theirs.lost, 0);
    assert!(ours.arrived_s < theirs.arrived_s && ours.near_s < theirs.near_s);
    assert!(ours.changes <= theirs.changes && ours.late_s < theirs.late_s);
    assert!(ours.moment < theirs.moment && ours.force < theirs.force);
    // What it fails of the requirements: a law without a parked state goes on turning.
    assert!(theirs.late_s > 1.0 && ours.late_s < 1.0);
}
