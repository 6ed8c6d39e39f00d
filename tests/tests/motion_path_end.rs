//! The end of a path that comes to rest: a robot beside it is led to the goal.

use controller_core::maths::Libm;
use controller_core::motion::{PathEnd, REFERENCE_TURN_SHARE, Task};
use controller_core::pose_error::PoseError;
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::types::{Accel, Pose, Twist, Wrench};
use tests::motion_base::{Base, Body};
use tests::motion_tracking::Exact;

/// An arc of some curvature \[1/m\], driven evenly and then braked evenly to rest, forward or backward.
#[derive(Clone, Copy, Debug)]
struct Arc {
    curvature: f64,
    /// Of the even part \[m/s\]; below 0 backward.
    speed: f64,
    /// \[s\].
    even_s: f64,
    /// \[m/s²\].
    brake: f64,
}

impl Arc {
    fn end_s(&self) -> f64 {
        self.even_s + self.speed.abs() / self.brake
    }

    /// Reference at `t`.
    fn at(&self, t: f64) -> Reference<f64> {
        let way = self.speed.signum();
        let whole = self.speed.abs() * (self.even_s + 0.5 * self.speed.abs() / self.brake);
        let braked = (t - self.even_s).clamp(0.0, self.end_s() - self.even_s);
        let speed = self.speed.abs() - self.brake * braked;
        let rest = t >= self.end_s();
        let driven =
            self.speed.abs() * t.min(self.even_s) + braked * 0.5 * (speed + self.speed.abs());
        let (v, s) = (if rest { 0.0 } else { way * speed }, way * driven);
        let a = if t > self.even_s && !rest {
            -way * self.brake
        } else {
            0.0
        };
        let path = ConstantTwist {
            start: Pose::default(),
            twist: Twist::new(1.0, self.curvature),
        };
        let pose = *path.at::<Libm>(s).pose();
        let (twist, accel) = (
            Twist::new(v, self.curvature * v),
            Accel::new(a, self.curvature * a),
        );
        Reference::new_with::<Libm>(pose, twist, accel).with_left(whole - driven)
    }
}

/// A pose to the left of a reference.
fn aside_of(reference: &Reference<f64>, aside: f64) -> Pose<f64> {
    let (pose, heading) = (reference.pose(), reference.heading());
    Pose {
        x: pose.x - heading.sin * aside,
        y: pose.y + heading.cos * aside,
        ..*pose
    }
}

/// What the robot lacks of the goal half a second after the path's end, `aside` of the path at its start.
fn left_at_the_end(arc: &Arc, aside: f64, leads: bool) -> PoseError<f64> {
    let dt = 0.01;
    let base = Base::STANDARD;
    let motion = base.exact().validate().expect("valid");
    let body = Body {
        twist: *arc.at(0.0).twist(),
        ..Body::at(0.0, aside, 0.0)
    };
    let mut drive = Exact::start(&motion, base, body, &Task::Follow(arc.at(0.0)), dt);
    let mut end = PathEnd::NEW;
    while drive.t < arc.end_s() + 0.5 {
        let now = drive.t + dt;
        let reference = arc.at(now);
        // The acceleration that is held meanwhile.
        let ahead = *arc.at(now + 0.5 * dt).accel();
        let reference = Reference::new_with::<Libm>(*reference.pose(), *reference.twist(), ahead)
            .with_left(reference.left_m());
        drive.coast(&Wrench::default());
        let measured = drive.body.measured();
        let mut followed = reference;
        if leads {
            end.lead::<Libm>(&motion, &mut followed, &measured.pose, dt);
        }
        drive.take(&Task::Follow(followed), &measured);
    }
    drive.error(&Task::Follow(arc.at(arc.end_s())))
}

const ARCS: [Arc; 4] = [
    Arc {
        curvature: 0.0,
        speed: 0.6,
        even_s: 0.3,
        brake: 0.5,
    },
    Arc {
        curvature: 1.0,
        speed: 0.6,
        even_s: 0.3,
        brake: 0.5,
    },
    Arc {
        curvature: 0.5,
        speed: -0.6,
        even_s: 0.5,
        brake: 0.5,
    },
    Arc {
        curvature: -1.5,
        speed: 0.4,
        even_s: 0.5,
        brake: 0.3,
    },
];

/// 9 mm aside when a second and a half is left: what `docs/motion.md` says that feedback leaves of it, and leading, forward and
/// backward, on lines and arcs.
#[test]
fn what_a_robot_is_aside_is_gone_by_the_end() {
    for arc in ARCS {
        for aside in [-9e-3, 9e-3] {
            let [followed, led] = [false, true].map(|leads| left_at_the_end(&arc, aside, leads));
            println!("{arc:?} {aside}: {followed:?} {led:?}");
            assert!(
                (0.9e-3..2.6e-3).contains(&followed.y.abs()),
                "{arc:?}: {followed:?}"
            );
            assert!(led.y.abs() < 0.05e-3, "{arc:?}: {led:?}");
        }
    }
}

/// On its path a robot gets its reference bit for bit, however it trembles within half of what is tolerated; and so does one whose
/// numbers are none, or that stands.
#[test]
fn on_its_path_nothing_changes() {
    let motion = Base::STANDARD.exact().validate().expect("valid");
    let tolerated = 0.5 * motion.params().arrival.distance_m;
    for arc in ARCS {
        let mut end = PathEnd::NEW;
        for tick in 0..200 {
            let reference = arc.at(0.01 * f64::from(tick));
            let at = aside_of(&reference, 0.99 * tolerated * f64::from(tick).sin());
            let mut led = |reference: &Reference<f64>, at: &Pose<f64>| {
                let mut led = *reference;
                end.lead::<Libm>(&motion, &mut led, at, 0.01);
                assert_eq!(end, PathEnd::NEW);
                led
            };
            assert_eq!(led(&reference, &at), reference);
            for wild in [f64::NAN, f64::INFINITY] {
                assert_eq!(led(&reference, &Pose::new(wild, 0.0, 0.0)), reference);
                let lost = led(&reference.with_left(wild), &at);
                assert_eq!(lost.left_m().to_bits(), wild.to_bits());
                assert_eq!(lost.with_left(0.0), reference.with_left(0.0));
            }
        }
    }
}

/// What is led along is a motion: its pose moves by its twist, that by its acceleration; and it asks for no more turning than
/// references leave.
#[test]
fn what_leads_is_a_motion_within_what_references_leave() {
    let motion = Base::STANDARD.exact().validate().expect("valid");
    let limit = motion.params().limits.turn_accel;
    let h = 1e-4;
    for arc in ARCS {
        let mut end = PathEnd::NEW;
        let reference = arc.at(arc.even_s);
        let left = reference.left_m();
        // As late as it begins, of an error that asks for three quarters of it.
        let v = reference.twist().linear;
        let spare = (1.0 - REFERENCE_TURN_SHARE) * limit;
        let aside = 0.75 * spare * left.powi(3) / (24.0 * v * v);
        let at = aside_of(&reference, aside);
        let mut first = reference;
        end.lead::<Libm>(&motion, &mut first, &at, 0.01);
        assert!((first.pose().x - at.x).hypot(first.pose().y - at.y) < 1e-12);
        let mut led = |t: f64| {
            // A robot that is where it is led to needs no other curve.
            let (mut held, mut led) = (end, arc.at(t));
            held.lead::<Libm>(&motion, &mut led, &at, 1e-9);
            led
        };
        let mut most = 0.0_f64;
        for step in 1..95 {
            let t = arc.even_s + 0.01 * f64::from(step) * (arc.end_s() - arc.even_s);
            let [before, now, after] = [t - h, t, t + h].map(&mut led);
            let rate = |of: fn(&Reference<f64>) -> f64| (of(&after) - of(&before)) / (2.0 * h);
            let (twist, accel) = (now.twist(), now.accel());
            let (dx, dy) = (rate(|r| r.pose().x), rate(|r| r.pose().y));
            let heading = now.heading();
            // To the third power of a slope of at most 0.1, and the square of h.
            for (is, expected) in [
                (dx, twist.linear * heading.cos),
                (dy, twist.linear * heading.sin),
                (rate(|r| r.pose().theta), twist.angular),
                (rate(|r| r.twist().linear), accel.linear),
                (rate(|r| r.twist().angular), accel.angular),
            ] {
                assert!((is - expected).abs() < 2e-3, "{arc:?} {t}: {is} {expected}");
            }
            let reference = arc.at(t);
            most = most.max((accel.angular - reference.accel().angular).abs());
        }
        println!("{arc:?}: {:.2} of the limit", most / limit);
        assert!(most < spare, "{arc:?}: {most}");
    }
}
