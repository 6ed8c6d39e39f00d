//! What the localiser refuses to be set up with.

use controller_core::error::Field;
use controller_core::localiser::{FusionParams, LocaliserParams};
use controller_core::maths::Libm;
use tests::encoded::{bases, odometry};
use tests::localised::SPEED;

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
