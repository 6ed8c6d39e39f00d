//! The laws that `sim-host bench` compares with, a tick each: following a reference, and parking.

use core::hint::black_box;

use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};
use firmware_demo::board::{Meter, Spread};
use firmware_demo::robots::LAB_10KG;
use rivals::{
    Aicardi, Body, Gain, Graceful, Job, LtvUnicycle, Now, Path, PurePursuit, Ramsete, Rival,
    Samson, TurnDriveTurn, TwoPids,
};

use crate::peers::Inputs;

const COUNT: u32 = 1000;
/// Samples of the path, as far as a lookahead of a metre reaches at 10 ms.
const SAMPLES: usize = 256;

/// The base of 10 kg.
const BODY: Body = Body {
    limits: LAB_10KG.base.motion.limits,
    period_s: 0.01,
    distance_m: 0.005,
    heading_rad: 0.01,
};

/// Counts all of them.
pub fn run(meter: &mut Meter) {
    let laws = &black_box(BODY);
    let usual = self::usual::<{ TurnDriveTurn::GAINS.len() }>(&TurnDriveTurn::GAINS);
    count(
        meter,
        ["rival/follow/turn-drive-turn", "rival/park/turn-drive-turn"],
        &mut TurnDriveTurn::new(laws, &usual),
    );
    let usual = self::usual::<{ Ramsete::GAINS.len() }>(&Ramsete::GAINS);
    count(
        meter,
        ["rival/follow/ramsete", "rival/park/ramsete"],
        &mut Ramsete::new(laws, &usual),
    );
    let usual = self::usual::<{ LtvUnicycle::GAINS.len() }>(&LtvUnicycle::GAINS);
    count(
        meter,
        ["rival/follow/ltv", "rival/park/ltv"],
        &mut LtvUnicycle::new(laws, &usual),
    );
    let usual = self::usual::<{ Graceful::GAINS.len() }>(&Graceful::GAINS);
    count(
        meter,
        ["rival/follow/graceful", "rival/park/graceful"],
        &mut Graceful::new(laws, &usual, true),
    );
    count(
        meter,
        [
            "rival/follow/graceful-on-the-way",
            "rival/park/graceful-on-the-way",
        ],
        &mut Graceful::new(laws, &usual, false),
    );
    let usual = self::usual::<{ PurePursuit::GAINS.len() }>(&PurePursuit::GAINS);
    count(
        meter,
        ["rival/follow/pure-pursuit", "rival/park/pure-pursuit"],
        &mut PurePursuit::new(laws, &usual),
    );
    let usual = self::usual::<{ Aicardi::GAINS.len() }>(&Aicardi::GAINS);
    count(
        meter,
        ["rival/follow/aicardi", "rival/park/aicardi"],
        &mut Aicardi::new(laws, &usual),
    );
    let usual = self::usual::<{ Samson::GAINS.len() }>(&Samson::GAINS);
    count(
        meter,
        ["rival/follow/samson", "rival/park/samson"],
        &mut Samson::new(laws, &usual),
    );
    let usual = self::usual::<{ TwoPids::GAINS.len() }>(&TwoPids::GAINS);
    count(
        meter,
        ["rival/follow/two-pids", "rival/park/two-pids"],
        &mut TwoPids::new(laws, &usual),
    );
}

fn usual<const N: usize>(gains: &[Gain; N]) -> [f32; N] {
    black_box(gains.map(|gain| gain.usual))
}

/// A path at 0.4 m/s along x, and a robot near it; then a goal, and a robot around it.
#[inline(never)]
fn count<R: Rival>(meter: &mut Meter, names: [&str; 2], law: &mut R) {
    let mut samples = [Reference::at_rest(Pose::default()); SAMPLES];
    for (at, sample) in samples.iter_mut().enumerate() {
        let pose = Pose::new(0.004 * at as f32, 0.0, 0.0);
        *sample = Reference::new(pose, Twist::new(0.4, 0.0), Accel::default());
    }
    let mut inputs = Inputs::new(3);
    let (mut follow, mut park) = (Spread::new(), Spread::new());
    let mut tick = 0;
    // Once along the path: laws that follow paths never go back.
    while tick + 1 < SAMPLES {
        tick += 1;
        let near = Pose::new(
            0.004 * tick as f32 + 0.02 * inputs.real(),
            0.02 * inputs.real(),
            0.2 * inputs.real(),
        );
        let path = Path {
            samples: &samples,
            tick,
        };
        follow.add(one(meter, law, &near, &Job::Follow(path)));
    }
    for _ in 0..COUNT {
        let around = Pose::new(inputs.real(), inputs.real(), 1.5 * inputs.real());
        park.add(one(meter, law, &around, &Job::Park(Pose::default())));
    }
    follow.print(names[0]);
    park.print(names[1]);
}

fn one<R: Rival>(meter: &mut Meter, law: &mut R, pose: &Pose<f32>, job: &Job<'_>) -> u32 {
    let now = black_box(Now {
        pose: *pose,
        twist: Twist::new(0.3, 0.1),
        dt: 0.01,
    });
    let (wanted, cost) = meter.measure(|| law.advance(&now, job));
    black_box(wanted);
    cost
}
