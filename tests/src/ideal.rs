//! The ideal loop: any controller, and a robot that does exactly what the torques held over a tick make of it.
//!
//! Measurements, tasks and what comes between them are the test's: it lets the robot move for a tick ([`Loop::hold`],
//! [`Loop::roll`]), then calls the controller. The realistic plant has a loop of its own, `sim_host::closed_loop`.

use rayon::prelude::*;

/// A robot that moves under a held wrench.
pub trait Robot: Copy {
    /// What it is made of.
    type Build;
    /// What is held over a tick.
    type Held;

    /// The robot after `dt`.
    fn after(&self, build: &Self::Build, held: &Self::Held, dt: f64) -> Self;
}

/// Controller and robot.
#[derive(Clone, Copy, Debug)]
pub struct Loop<C, R: Robot> {
    /// The controller.
    pub controller: C,
    /// The true robot.
    pub body: R,
    /// What the robot is made of; not what the controller believes.
    pub plant: R::Build,
    /// Time \[s\].
    pub t: f64,
    /// Tick \[s\].
    pub dt: f64,
    ticks: u32,
}

impl<C, R: Robot> Loop<C, R> {
    /// At t = 0, the controller started.
    pub const fn new(controller: C, body: R, plant: R::Build, dt: f64) -> Self {
        Self {
            controller,
            body,
            plant,
            t: 0.0,
            dt,
            ticks: 0,
        }
    }

    /// The robot alone, over one tick.
    pub fn hold(&mut self, held: &R::Held) {
        self.roll(|body, plant, dt| body.after(plant, held, dt));
    }

    /// The robot alone, over one tick in which it moves as said.
    pub fn roll(&mut self, motion: impl FnOnce(&R, &R::Build, f64) -> R) {
        self.body = motion(&self.body, &self.plant, self.dt);
        self.ticks += 1;
        self.t = f64::from(self.ticks) * self.dt;
    }
}

/// `work` on every item, on all cores; results in order.
pub fn on_all_cores<A: Sync, B: Send>(items: &[A], work: impl Fn(&A) -> B + Sync + Send) -> Vec<B> {
    items.par_iter().map(work).collect()
}
