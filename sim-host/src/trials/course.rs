//! The courses: the paper's two cases, and a park.

use crate::mission::{BaseSpec, Course as Way, End, HandOverRule, Mission, Route, When};
use crate::motion::ReferenceMotion;
use crate::precision::Precision;
use controller_core::reference::ConstantTwist;
use controller_core::types::{Measured, Pose, Twist};
use serde::{Deserialize, Serialize};

/// What a base has to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Course {
    /// The paper's line, Fig. 3: from rest, 1 m beside it, to 4 m along it.
    Line,
    /// The paper's curve, Fig. 4: the same along an arc that ends 1.5 rad further left.
    Curve,
    /// From rest, 0.5 m beside the goal and with its heading.
    Park,
}

/// Speed \[m/s\] and turn rate \[rad/s\] of the paper's references.
const PAPER: (f64, f64) = (0.4, 0.15);
/// Length of both \[m\].
const LENGTH_M: f64 = 4.0;
/// The paper's cases use no more than this share of a base's speed and turn rate; a slower base drives
/// the same way in more time.
const SHARE: f64 = 0.5;
/// How long parking may take \[s\]: five times what the slowest of the example bases needs.
const PARKING_S: f64 = 40.0;

impl Course {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Line, Self::Curve, Self::Park];

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Curve => "curve",
            Self::Park => "park",
        }
    }

    /// The mission of a base, still without a world.
    pub fn mission(self, base: &BaseSpec) -> Mission {
        let (aside, course, end_s) = match self {
            Self::Line => follow(base, 0.0),
            Self::Curve => follow(base, PAPER.1),
            Self::Park => (0.5, Way::Park(Pose::default()), 0.0),
        };
        Mission {
            name: self.name().to_owned(),
            description: format!("{} of a {}", self.name(), base.name),
            base: base.clone(),
            robot: base.robot,
            precision: Precision::F32,
            start: Measured {
                pose: Pose::new(0.0, aside, 0.0),
                twist: Twist::default(),
            },
            course,
            events: Vec::new(),
            period_s: base.period_s(),
            end: End::Parked(end_s + PARKING_S),
            setup: None,
        }
    }
}

fn follow(base: &BaseSpec, turn: f64) -> (f64, Way, f64) {
    let limits = &base.limits;
    let slower = |share: f64, limit: f64| (SHARE * limit / share).min(1.0);
    let pace = slower(PAPER.0, limits.speed).min(if turn > 0.0 {
        slower(turn, limits.turn_rate)
    } else {
        1.0
    });
    let motion = ReferenceMotion::Constant(ConstantTwist {
        start: Pose::default(),
        twist: Twist::new(pace * PAPER.0, pace * turn),
    });
    let end_s = LENGTH_M / (pace * PAPER.0);
    let hand_over = HandOverRule {
        goal: *motion.at(end_s).pose(),
        end_s,
        when: When::Distance,
    };
    let course = Way::Follow {
        route: Route::Motion(motion),
        hand_over: Some(hand_over),
    };
    (1.0, course, end_s)
}
