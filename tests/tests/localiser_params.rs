//! What the localiser refuses to be set up with.

use controller_core::error::Field;
use controller_core::localiser::{FusionParams, LocaliserParams};
use controller_core::maths::Libm;
use controller_core::motion::Arrival;
use tests::check::assert_within;
use tests::encoded::{bases, odometry};
use tests::localised::SPEED;

/// A robot has arrived where the noise of its pose and a count of its wheels leave nothing to tell; with fixes, however precise, not closer than 1 mm and
/// 2 mrad, within which odometry leads that may be off by 2 % of 5 cm and 0.1 rad.
#[test]
fn arrival_is_what_noise_and_counts_leave() {
    let (_, file) = bases()[1].clone();
    let exact = Arrival::<f64>::exact();
    for (noise, bandwidth, heading_bandwidth, counts) in [
        (5e-3, 0.8, 0.4, 2048.0),
        (5e-3, 0.4, 0.8, 64.0),
        (1e-4, 0.05, 0.2, 2048.0),
        (1e-4, 4.0, 4.0, 65536.0),
    ] {
        let mut fusion = FusionParams::for_source(noise, noise, 20.0);
        (fusion.bandwidth, fusion.heading_bandwidth) = (bandwidth, heading_bandwidth);
        let mut params = LocaliserParams {
            odometry: odometry(&file, SPEED),
            fusion: Some(fusion),
            gyro: None,
        };
        params.odometry.counts_per_turn = counts;
        let localisation = params.validate_with::<Libm>().expect("valid");
        let arrival = localisation.arrival();
        let filtered = f64::max(localisation.filtered_noise_m(), 0.25 * 0.02 * 0.05);
        let count = params.odometry.travel_per_count_m();
        // Roundings.
        let slack = 1e-15;
        let pose_noise = f64::hypot(0.6 * filtered, 0.288_675 * count);
        assert_within(localisation.pose_noise_m(), pose_noise, slack, "noise");
        let distance = (5.0 * pose_noise + filtered).max(exact.distance_m);
        assert_within(arrival.distance_m, distance, slack, "distance");
        let heading = (8.0 * localisation.filtered_noise_rad()).max(0.02 * 0.1);
        let turn = count / params.odometry.track_m();
        assert_within(arrival.heading_rad, heading + turn, slack, "heading");
        let slower = f64::min(bandwidth, heading_bandwidth);
        assert_within(arrival.dwell_s, (1.0 / slower).min(10.0), slack, "dwell");
    }
}

/// A source's noise is filtered to a seventh, but no slower than shows in the tolerance, and no faster than a base follows.
#[test]
fn a_precise_source_is_filtered_less() {
    for (noise, rate_hz, expected) in [
        (5e-3, 20.0, 0.8),
        (5e-3, 100.0, 1.0),
        // 2 · 20 Hz (0.25/1)²
        (1e-3, 20.0, 2.5),
        (0.5e-3, 20.0, 4.0),
        (1e-3, 100.0, 4.0),
        (1e-5, 1.0, 4.0),
    ] {
        let of = FusionParams::<f64>::for_source;
        let (position, heading) = (of(noise, 1.0, rate_hz), of(1.0, noise, rate_hz));
        // Roundings.
        assert_within(position.bandwidth, expected, 1e-12, "position");
        assert_within(heading.heading_bandwidth, expected, 1e-12, "heading");
    }
}

/// Parameters out of range are named.
#[test]
fn bad_parameters_are_named() {
    let (_, file) = bases()[1].clone();
    let refused = |change: &dyn Fn(&mut FusionParams<f64>)| {
        let mut fusion = FusionParams::for_source(5e-3, 5e-3, 20.0);
        change(&mut fusion);
        let params = LocaliserParams {
            odometry: odometry(&file, SPEED),
            fusion: Some(fusion),
            gyro: None,
        };
        params
            .validate_with::<Libm>()
            .expect_err("out of range")
            .field
    };
    assert_eq!(refused(&|p| p.noise_m = 0.0), Field::FixNoise);
    assert_eq!(refused(&|p| p.noise_rad = f64::NAN), Field::FixHeadingNoise);
    assert_eq!(refused(&|p| p.rate_hz = 0.0), Field::FixRate);
    assert_eq!(refused(&|p| p.bandwidth = -1.0), Field::FixBandwidth);
    assert_eq!(
        refused(&|p| p.heading_bandwidth = 101.0),
        Field::FixHeadingBandwidth
    );
    assert_eq!(refused(&|p| p.gate = 1.0), Field::FixGate);
    assert_eq!(refused(&|p| p.relocalise_after = 1), Field::RelocaliseAfter);
    assert_eq!(refused(&|p| p.drift = 0.6), Field::OdometryDrift);
    assert_eq!(refused(&|p| p.slide_m_s = -0.1), Field::SlideSpeed);
    assert_eq!(refused(&|p| p.stale_s = 0.0), Field::FixStale);
    let mut params = LocaliserParams {
        odometry: odometry::<f64>(&file, SPEED),
        fusion: None,
        gyro: None,
    };
    params.odometry.calibration.track = 3.0;
    let error = params.validate_with::<Libm>().expect_err("out of range");
    assert_eq!(error.field, Field::CalibrationTrack);
}
