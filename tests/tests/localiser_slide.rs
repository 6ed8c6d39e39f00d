//! Wheels that slide: fixes that agree with each other, but not with the encoders.

use controller_core::hal::WheelCounts;
use controller_core::localiser::{
    Fix, FixOutcome, FusionParams, Localiser, LocaliserParams, ValidLocaliserParams,
};
use controller_core::maths::Libm;
use controller_core::types::Pose;
use tests::encoded::{bases, odometry};
use tests::localised::SPEED;

const DT: f64 = 0.01;
/// 20 Hz.
const TICKS_PER_FIX: usize = 5;

fn localisation(slide_m_s: f64) -> ValidLocaliserParams<f64> {
    let (_, file) = bases()[1].clone();
    let mut fusion = FusionParams::for_source(5e-3, 5e-3, 20.0);
    fusion.slide_m_s = slide_m_s;
    let params = LocaliserParams {
        odometry: odometry(&file, SPEED),
        fusion: Some(fusion),
        gyro: None,
    };
    params.validate_with::<Libm>().expect("valid")
}

/// What came of the fixes of a robot whose wheels stand while it turns at `rate` \[rad/s\] for `slide_s`, and then
/// rests for `rest_s`.
struct Slid {
    relocalised: usize,
    /// Largest heading error after the first relocalisation, while it slides \[rad\].
    off_rad: f64,
    /// Fixes until one is fused again, once it rests.
    until_fused: Option<usize>,
    stale: bool,
}

fn slide(localisation: &ValidLocaliserParams<f64>, rate: f64, slide_s: f64, rest_s: f64) -> Slid {
    let counts = WheelCounts::default();
    let mut localiser =
        Localiser::<f64, 32>::start(localisation, Pose::default(), counts).expect("finite");
    let mut slid = Slid {
        relocalised: 0,
        off_rad: 0.0,
        until_fused: None,
        stale: false,
    };
    let mut after = 0;
    let ticks = ((slide_s + rest_s) / DT).round() as usize;
    for k in 1..=ticks {
        let t = k as f64 * DT;
        let theta = rate * t.min(slide_s);
        let fix = (k % TICKS_PER_FIX == 0).then(|| Fix {
            pose: Pose::new(0.0, 0.0, theta),
            age_s: 0.0,
        });
        let estimate = localiser
            .update::<Libm>(counts, DT, fix.as_ref())
            .expect("accepted");
        slid.relocalised += usize::from(estimate.jumped);
        slid.stale |= estimate.stale;
        if t <= slide_s {
            if slid.relocalised > 0 {
                slid.off_rad = slid
                    .off_rad
                    .max((estimate.measured.pose.theta - theta).abs());
            }
        } else if fix.is_some() && slid.until_fused.is_none() {
            after += 1;
            if estimate.fix == FixOutcome::Fused {
                slid.until_fused = Some(after);
            }
        }
    }
    slid
}

/// A second at 1.5 rad/s, which is 75 mrad from fix to fix against a gate of 27: the third fix is believed, and again
/// every third; the pose is never older than three fixes.
#[test]
fn a_short_slide_is_followed() {
    let slid = slide(&localisation(0.5), 1.5, 1.0, 1.0);
    // 20 fixes in the slide, and up to three after its end.
    assert!((6..=8).contains(&slid.relocalised), "{}", slid.relocalised);
    // Three fixes and the time to the third: 1.5 rad/s for 0.2 s.
    assert!(slid.off_rad < 1.5 * 0.2 + 1e-9, "{}", slid.off_rad);
    assert!(!slid.stale);
    assert!(slid.until_fused.is_some_and(|fixes| fixes <= 4));
}

/// Without leave to slide nothing is believed until the robot rests, and the pose is stale meanwhile.
#[test]
fn without_leave_to_slide_the_pose_grows_stale() {
    let slid = slide(&localisation(0.0), 1.5, 1.0, 1.0);
    assert!(slid.stale);
    // At rest three fixes agree, the first of which may be the last of the slide.
    assert_eq!(slid.relocalised, 1);
    assert!(slid.until_fused.is_some_and(|fixes| fixes <= 4));
}

/// An encoder that lies for good is not followed for good: after nine relocalisations the pose grows stale, which is
/// a fault. At rest it is found again, however long the slide was.
#[test]
fn an_endless_slide_ends_stale() {
    let slid = slide(&localisation(0.5), 1.5, 10.0, 1.0);
    // Nine while it slides, one at rest.
    assert_eq!(slid.relocalised, 10);
    assert!(slid.stale);
    assert!(slid.until_fused.is_some_and(|fixes| fixes <= 4));
}

/// Faster than wheels can slide is nonsense: 0.5 m/s at each wheel of 0.35 m are 2.9 rad/s, and 35 mrad a fix.
#[test]
fn what_no_slide_explains_is_not_followed() {
    let slid = slide(&localisation(0.5), 6.0, 1.0, 0.0);
    assert_eq!(slid.relocalised, 0);
    assert!(slid.stale);
}
