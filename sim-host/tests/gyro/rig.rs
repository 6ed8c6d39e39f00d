//! A base in a world, driven by orders, tick by tick.

use controller_core::base::{BaseReport, Order};
use controller_core::queue::ReferenceQueue;
use controller_core::types::{Pose, Twist};
use protocol::Command;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64Mcg;
use sim_host::closed_loop::ClosedLoop;
use sim_host::mission::{BaseSpec, Mission};
use sim_host::rate::Rate;
use sim_host::trials::{Condition, Course, setup};
use sim_host::world::{World, WorldSetup};

/// Seeds that are not those of the documents' figures.
pub fn is_fresh() -> bool {
    ["GYRO_SEED", "GYRO_SEEDS"]
        .iter()
        .any(|name| std::env::var_os(name).is_some())
}

/// First seed of the runs here, and how many there are: `GYRO_SEED` and `GYRO_SEEDS` are others.
pub fn seeds(count: u64) -> std::ops::Range<u64> {
    let number = |name| std::env::var(name).ok().and_then(|text| text.parse().ok());
    let first = number("GYRO_SEED").unwrap_or(7_300_417_u64);
    first..first + number("GYRO_SEEDS").unwrap_or(count)
}

/// No more than the page states, failed and runs.
pub fn is_as_stated(what: &str, rate: Rate, stated: &[f64]) {
    let most = Rate {
        failed: stated[0] as usize,
        runs: stated[1] as usize,
    };
    println!("{what}: {rate}");
    assert!(!rate.exceeds(&most), "{what}: {rate}; stated {most}");
}

/// Numbers that are settled by a seed.
pub struct Draw(Pcg64Mcg);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let share: f64 = StandardUniform.sample(&mut self.0);
        low + (high - low) * share
    }
}

/// What a base is and where it is.
pub struct Rig<'a> {
    pub base: ClosedLoop<'a>,
    pub t: f64,
    pub dt: f64,
}

/// The bad floor of a base, all drawn by the seed.
pub fn bad_floor(base: &BaseSpec, seed: u64) -> WorldSetup {
    setup(base, Condition::Drawn, seed)
}

/// The mission of a base that starts at the origin.
pub fn mission(base: &BaseSpec) -> Mission {
    let mut mission = Course::Park.mission(base);
    mission.start.pose = Pose::default();
    mission
}

impl<'a> Rig<'a> {
    /// At rest at the origin for a second, then armed.
    pub fn start(
        queue: &'a mut ReferenceQueue<f32, 2>,
        mission: &Mission,
        setup: &WorldSetup,
    ) -> Self {
        let base = ClosedLoop::new(queue.split().1, mission, setup, None).expect("a base");
        let dt = mission.period_s;
        let mut rig = Self { base, t: 0.0, dt };
        while rig.t < 1.0 {
            rig.tick(&Order::None);
        }
        rig.base
            .command(&Command::Arm)
            .expect("there is no mirror")
            .expect("armed");
        rig
    }

    pub fn tick(&mut self, order: &Order<f32>) -> BaseReport<f32> {
        self.base.advance().expect("a tick");
        self.t = 1.0e-6 * self.world().now_us() as f64;
        *self.base.tick(order).expect("there is no mirror")
    }

    pub fn world(&self) -> &World {
        self.base.world()
    }

    /// Believed less true heading \[rad\].
    pub fn heading_error(&self) -> f64 {
        let believed = self.base.report().measured.expect("measured").pose.theta;
        f64::from(believed) - self.world().truth().pose.theta
    }
}

/// Velocity orders within shares of a base's limits, another one every 1 to 3 s.
pub struct Wander {
    draw: Draw,
    twist: Twist<f32>,
    until: f64,
    speed: f64,
    turn: f64,
}

impl Wander {
    pub fn new(base: &BaseSpec, seed: u64) -> Self {
        Self {
            draw: Draw::new(seed),
            twist: Twist::default(),
            until: 0.0,
            speed: 0.6 * base.limits.speed,
            turn: 0.3 * base.limits.turn_rate,
        }
    }

    pub fn at(&mut self, t: f64) -> Order<f32> {
        if t >= self.until {
            self.until = t + self.draw.between(1.0, 3.0);
            let (v, w) = (
                self.draw.between(0.2, 1.0) * self.speed,
                self.draw.between(-1.0, 1.0) * self.turn,
            );
            self.twist = Twist::new(v as f32, w as f32);
        }
        Order::Drive {
            twist: self.twist,
            hold_heading: false,
        }
    }
}
