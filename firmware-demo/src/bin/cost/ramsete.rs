//! A peer: the Ramsete law, which many mobile robots run, written over the same maths.
//!
//! It is kinematic: pose error to velocities, without neurons, rates, torques, limit and report.

use core::hint::black_box;

use controller_core::angle::wrap;
use controller_core::maths::Maths;
use controller_core::types::{Pose, Twist};
use firmware_demo::board::Meter;

use crate::inputs::Inputs;
use crate::print::Row;

const COUNT: u32 = 1000;

/// The gains b \[rad²/m²\] and ζ.
struct Ramsete {
    b: f32,
    zeta: f32,
}

impl Ramsete {
    /// v = v_r cos e_θ + k e_x, w = w_r + k e_θ + b v_r sinc(e_θ) e_y, k = 2 ζ √(w_r² + b v_r²).
    #[inline(never)]
    fn command<M: Maths<f32>>(
        &self,
        from: &Pose<f32>,
        r: &Twist<f32>,
        to: &Pose<f32>,
    ) -> Twist<f32> {
        let (sine, cosine) = M::sin_cos(to.theta);
        let (dx, dy) = (from.x - to.x, from.y - to.y);
        let (e_x, e_y) = (dx * cosine + dy * sine, dy * cosine - dx * sine);
        let e_theta = wrap(from.theta - to.theta);
        let (sine, cosine) = M::sin_cos(e_theta);
        let sinc = if e_theta.abs() < 1.0e-4 {
            1.0 - e_theta * e_theta * (1.0 / 6.0)
        } else {
            sine / e_theta
        };
        let k = 2.0 * self.zeta * M::sqrt(r.angular * r.angular + self.b * r.linear * r.linear);
        Twist {
            linear: r.linear * cosine + k * e_x,
            angular: r.angular + k * e_theta + self.b * r.linear * sinc * e_y,
        }
    }
}

/// Counts it over the ordinary inputs of a tick.
#[inline(never)]
pub fn measure<M: Maths<f32>>(meter: &mut Meter, name: &str) {
    let law = black_box(Ramsete { b: 2.0, zeta: 0.7 });
    let mut inputs = Inputs::new(7);
    let mut row = Row::new();
    let mut command = Twist::default();
    for _ in 0..COUNT {
        let from = Pose::new(inputs.real(2.0), inputs.real(2.0), inputs.real(1.5));
        let twist = Twist::new(inputs.real(1.0), inputs.real(1.0));
        let to = Pose {
            x: from.x + inputs.real::<f32>(0.1),
            y: from.y + inputs.real::<f32>(0.1),
            theta: from.theta + inputs.real::<f32>(1.5),
        };
        let cost = meter
            .measure(|| command = law.command::<M>(&from, &twist, &to))
            .1;
        row.add(cost);
        command = black_box(command);
    }
    row.print(&["peer", "ramsete", name]);
}
