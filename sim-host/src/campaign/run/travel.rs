//! How the true base moves and rests.

use crate::campaign::bounds::Bounds;
use crate::closed_loop::Board;
use controller_core::safety::supervisor::State;

/// Speeds below which a base rests, and for how long \[m/s, rad/s, s\]: twice the supervisor's.
const REST: (f64, f64, f64) = (0.02, 0.04, 0.2);

#[derive(Default)]
pub(super) struct Travel {
    /// How long the base has rested \[s\].
    pub(super) rest_s: f64,
    /// How long it has said that it is parked \[s\].
    pub(super) parked_s: f64,
    /// Way since the trouble began, and the largest speed since then \[m, m/s\].
    pub(super) way_m: f64,
    pub(super) fastest: f64,
    struck: bool,
}

impl Travel {
    /// The trouble begins.
    pub(super) const fn strike(&mut self) {
        self.struck = true;
        self.way_m = 0.0;
    }

    /// Takes the world after a tick's motion of `moved` \[m\], before the base has its tick.
    pub(super) fn account(&mut self, board: &Board<'_>, bounds: &Bounds, moved: f64) {
        let dt = 1.0e-6 * f64::from(board.dt_us());
        let twist = board.world().truth().twist;
        let wheels = board.world().wheel_speeds();
        self.way_m += moved;
        let rests = twist.linear.abs() < REST.0
            && twist.angular.abs() < REST.1
            && bounds.rolls(wheels.right, wheels.left) < 2.0 * REST.0;
        self.rest_s = if rests { self.rest_s + dt } else { 0.0 };
        let parked = board.report().state == State::Parked;
        self.parked_s = if parked { self.parked_s + dt } else { 0.0 };
        if self.struck {
            self.fastest = self.fastest.max(twist.linear.abs());
        }
    }

    pub(super) fn rests(&self) -> bool {
        self.rest_s > REST.2
    }
}
