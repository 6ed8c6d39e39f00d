//! Every law parks a unicycle that does what is wanted of it within its accelerations, and follows what moves.

use controller_core::maths::{Maths, Single};
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};
use firmware_demo::robots::LAB_10KG;
use rivals::{
    Aicardi, Body, Gain, Graceful, Job, LtvUnicycle, Now, Path, PurePursuit, Ramsete, Rival,
    Samson, TurnDriveTurn, TwoPids,
};

const BODY: Body = Body {
    limits: LAB_10KG.base.motion.limits,
    period_s: 0.01,
    distance_m: 0.005,
    heading_rad: 0.010,
};

fn usual(gains: &[Gain]) -> Vec<f32> {
    gains.iter().map(|gain| gain.usual).collect()
}

fn laws() -> Vec<(&'static str, Box<dyn Rival>)> {
    let body = &BODY;
    vec![
        (
            "turn-drive-turn",
            Box::new(TurnDriveTurn::new(body, &usual(&TurnDriveTurn::GAINS))),
        ),
        (
            "ramsete",
            Box::new(Ramsete::new(body, &usual(&Ramsete::GAINS))),
        ),
        (
            "ltv",
            Box::new(LtvUnicycle::new(body, &usual(&LtvUnicycle::GAINS))),
        ),
        (
            "graceful",
            Box::new(Graceful::new(body, &usual(&Graceful::GAINS), true)),
        ),
        (
            "on the way",
            Box::new(Graceful::new(body, &usual(&Graceful::GAINS), false)),
        ),
        (
            "pure pursuit",
            Box::new(PurePursuit::new(body, &usual(&PurePursuit::GAINS))),
        ),
        (
            "aicardi",
            Box::new(Aicardi::new(body, &usual(&Aicardi::GAINS))),
        ),
        (
            "two pids",
            Box::new(TwoPids::new(body, &usual(&TwoPids::GAINS))),
        ),
        (
            "samson",
            Box::new(Samson::new(body, &usual(&Samson::GAINS))),
        ),
    ]
}

/// A robot that follows demands within its accelerations.
struct Unicycle {
    pose: Pose<f32>,
    twist: Twist<f32>,
}

fn towards(from: f32, to: f32, step: f32) -> f32 {
    from + (to - from).clamp(-step, step)
}

impl Unicycle {
    fn advance(&mut self, wanted: Twist<f32>, dt: f32) {
        let limits = &BODY.limits;
        let most = (wanted.linear.abs() / limits.speed)
            .max(wanted.angular.abs() / limits.turn_rate)
            .max(1.0);
        self.twist.linear = towards(self.twist.linear, wanted.linear / most, limits.accel * dt);
        let step = limits.turn_accel * dt;
        self.twist.angular = towards(self.twist.angular, wanted.angular / most, step);
        let heading = self.pose.theta + 0.5 * dt * self.twist.angular;
        let (sine, cosine) = Single::sin_cos(heading);
        self.pose.x += dt * self.twist.linear * cosine;
        self.pose.y += dt * self.twist.linear * sine;
        self.pose.theta += dt * self.twist.angular;
    }

    fn is_at(&self, goal: &Pose<f32>, wide: f32) -> bool {
        let heading = controller_core::angle::wrap(goal.theta - self.pose.theta).abs();
        let (dx, dy) = (goal.x - self.pose.x, goal.y - self.pose.y);
        (dx * dx + dy * dy).sqrt() < wide * BODY.distance_m && heading < wide * BODY.heading_rad
    }
}

/// When it is parked, if it ever is within a time.
fn park(law: &mut dyn Rival, start: Pose<f32>, end_s: f32) -> Option<f32> {
    let (dt, goal) = (BODY.period_s, Pose::default());
    let mut robot = Unicycle {
        pose: start,
        twist: Twist::default(),
    };
    let mut inside = None;
    for tick in 0..(end_s / dt) as usize {
        let t = dt * tick as f32;
        let now = Now {
            pose: robot.pose,
            twist: robot.twist,
            dt,
        };
        let near = robot.is_at(&goal, if inside.is_some() { 2.0 } else { 1.0 });
        inside = near.then(|| inside.unwrap_or(t));
        let wanted = match near {
            true => Twist::default(),
            false => law.advance(&now, &Job::Park(goal)).expect("it parks").twist,
        };
        robot.advance(wanted, dt);
    }
    inside
}

#[test]
fn every_law_parks() {
    let starts = [
        Pose::new(-1.0, 0.4, 0.3),
        Pose::new(0.6, -0.8, 2.0),
        Pose::new(1.5, 1.0, -1.0),
        Pose::new(0.0, 0.5, 0.0),
    ];
    for start in starts {
        for (name, mut law) in laws() {
            let parked = park(law.as_mut(), start, 60.0);
            println!("{name} {start:?}: {parked:?}");
            // Samson's smooth law closes in slower than any exponential.
            if name != "samson" {
                assert!(parked.is_some(), "{name} from {start:?}");
            }
        }
    }
}

/// Along an arc at 0.5 m/s, from 0.1 m beside it: trackers are on it after 10 s.
#[test]
fn trackers_come_onto_an_arc() {
    let dt = BODY.period_s;
    let samples: Vec<Reference<f32>> = (0..3000)
        .map(|tick| {
            let angle = 0.3 * dt * tick as f32;
            let (sine, cosine) = Single::sin_cos(angle);
            let radius = 0.5 / 0.3;
            let pose = Pose::new(radius * sine, radius * (1.0 - cosine), angle);
            Reference::new(pose, Twist::new(0.5, 0.3), Accel::default())
        })
        .collect();
    for (name, mut law) in laws() {
        let mut robot = Unicycle {
            pose: Pose::new(0.0, 0.1, 0.0),
            twist: Twist::new(0.5, 0.3),
        };
        let mut off = 0.0;
        for tick in 0..1500 {
            let now = Now {
                pose: robot.pose,
                twist: robot.twist,
                dt,
            };
            let path = Path {
                samples: &samples,
                tick,
            };
            let wanted = law.advance(&now, &Job::Follow(path)).expect("it follows");
            robot.advance(wanted.twist, dt);
            let to = samples[tick + 1].pose();
            let (dx, dy) = (to.x - robot.pose.x, to.y - robot.pose.y);
            off = (dx * dx + dy * dy).sqrt();
        }
        println!("{name}: {off}");
        if ["turn-drive-turn", "ramsete", "ltv", "samson"].contains(&name) {
            assert!(off < 2e-3, "{name}: {off}");
        }
    }
}
