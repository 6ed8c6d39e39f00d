//! The stack, and a robot for it.

use core::f32::consts::TAU;
use core::hint::black_box;

use controller_core::maths::{Maths, Single};
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};
use firmware_demo::board::{Meter, Spread, thousand_nops};
use firmware_demo::robots::LAB_10KG;
use pid::Pid;
use rivals::{Body, Now, Ramsete};

/// Control period \[s\].
const DT: f32 = 0.01;
/// A lap of a circle of 0.5 m at 0.4 m/s, once it turns.
const TICKS: u32 = 1500;

/// What the stack knows of the robot; geometry of the 10 kg base, feed-forward and gains of a motor of 24 V.
#[derive(Clone, Copy)]
struct Constants {
    radius_m: f32,
    track_m: f32,
    rad_per_count: f32,
    /// Voltages for friction \[V\], per speed \[V s/rad\] and per acceleration \[V s²/rad\].
    feed_forward: (f32, f32, f32),
    supply_v: f32,
}

#[derive(Clone, Copy, Default)]
struct Wheel {
    counts: i32,
    target: f32,
}

struct Stack {
    constants: Constants,
    law: Ramsete,
    pose: Pose<f32>,
    wheels: [Wheel; 2],
    pids: [Pid<f32>; 2],
}

impl Stack {
    /// A tick: right and left counts to right and left duty.
    #[inline(never)]
    fn tick(&mut self, counts: [i32; 2], reference: &Reference<f32>, dt: f32) -> [f32; 2] {
        let constants = &self.constants;
        let rate = 1.0 / dt;
        let turned = |wheel: &mut Wheel, counts: i32| {
            let difference = counts.wrapping_sub(wheel.counts);
            wheel.counts = counts;
            difference as f32 * constants.rad_per_count
        };
        let [right, left] = &mut self.wheels;
        let turned = [turned(right, counts[0]), turned(left, counts[1])];
        // Odometry, along the chord of the arc.
        let way = 0.5 * constants.radius_m * (turned[0] + turned[1]);
        let turn = constants.radius_m * (turned[0] - turned[1]) / constants.track_m;
        let (sine, cosine) = Single::sin_cos(self.pose.theta + 0.5 * turn);
        self.pose.x += way * cosine;
        self.pose.y += way * sine;
        self.pose.theta += turn;
        let now = Now {
            pose: self.pose,
            twist: Twist::new(way * rate, turn * rate),
            dt,
        };
        let wanted = self.law.track(&now, reference).twist;
        // Speeds of the wheels that this twist asks for.
        let aside = 0.5 * constants.track_m * wanted.angular;
        let per_radius = 1.0 / constants.radius_m;
        let targets = [
            (wanted.linear + aside) * per_radius,
            (wanted.linear - aside) * per_radius,
        ];
        let (friction, per_speed, per_accel) = constants.feed_forward;
        let per_volt = 1.0 / constants.supply_v;
        let mut duties = [0.0; 2];
        for ((duty, pid), (wheel, (target, turned))) in duties
            .iter_mut()
            .zip(&mut self.pids)
            .zip(self.wheels.iter_mut().zip(targets.into_iter().zip(turned)))
        {
            let accel = (target - wheel.target) * rate;
            wheel.target = target;
            pid.setpoint(target);
            let feedback = pid.next_control_output(turned * rate).output;
            let friction = if target > 0.0 { friction } else { -friction };
            let volts = feedback + friction + per_speed * target + per_accel * accel;
            *duty = limited(volts * per_volt, 1.0);
        }
        duties
    }
}

/// Without the panic that `clamp` has for limits in the wrong order.
fn limited(value: f32, most: f32) -> f32 {
    if value > most {
        most
    } else if value < -most {
        -most
    } else {
        value
    }
}

/// Counts its ticks on a robot whose wheels follow their voltage within 50 ms.
pub fn run() {
    let mut meter = Meter::start();
    let mut nops = Spread::new();
    nops.add(meter.measure(thousand_nops).1);
    nops.print("thousand-nops");
    let wheels = LAB_10KG.base.localiser.odometry.wheels;
    let constants = black_box(Constants {
        radius_m: wheels.radius_right_m,
        track_m: wheels.track_m,
        rad_per_count: TAU / LAB_10KG.base.localiser.odometry.counts_per_turn,
        feed_forward: (0.5, 1.2, 0.06),
        supply_v: 24.0,
    });
    let mut pid = Pid::<f32>::new(0.0, constants.supply_v);
    pid.p(0.5, constants.supply_v)
        .i(0.02, 0.2 * constants.supply_v);
    pid.d(0.001, constants.supply_v);
    let body = Body {
        limits: LAB_10KG.base.motion.limits,
        period_s: DT,
        distance_m: 0.005,
        heading_rad: 0.01,
    };
    let mut stack = Stack {
        constants,
        law: Ramsete::new(&body, &Ramsete::GAINS.map(|gain| gain.usual)),
        pose: Pose::new(0.0, 0.05, 0.0),
        wheels: [Wheel::default(); 2],
        pids: [pid; 2],
    };
    let (mut speeds, mut angles) = ([0.0_f32; 2], [0.0_f32; 2]);
    let mut spread = Spread::new();
    let (friction, per_speed, _) = constants.feed_forward;
    for tick in 0..TICKS {
        let t = DT * tick as f32;
        let (sine, cosine) = Single::sin_cos(0.8 * t);
        let reference = black_box(Reference::new(
            Pose::new(0.5 * sine, 0.5 - 0.5 * cosine, 0.8 * t),
            Twist::new(0.4, 0.8),
            Accel::default(),
        ));
        let counts = black_box(angles.map(|angle| (angle / constants.rad_per_count) as i32));
        let mut duties = [0.0; 2];
        let cost = meter
            .measure(|| duties = stack.tick(counts, &reference, DT))
            .1;
        spread.add(cost);
        for ((speed, angle), duty) in speeds.iter_mut().zip(&mut angles).zip(duties) {
            let held = limited(duty * constants.supply_v, friction);
            let wanted = (duty * constants.supply_v - held) / per_speed;
            *speed += (wanted - *speed) * (DT / 0.05);
            *angle += DT * *speed;
        }
    }
    spread.print("peer/stack");
    // What does not follow would not be what it claims to be.
    let (sine, cosine) = Single::sin_cos(0.8 * DT * TICKS as f32);
    let (dx, dy) = (stack.pose.x - 0.5 * sine, stack.pose.y - 0.5 + 0.5 * cosine);
    let off_mm = 1.0e3 * Single::sqrt(dx * dx + dy * dy);
    let mut off = Spread::new();
    off.add(off_mm as u32);
    off.print("peer/stack-off-mm");
}
