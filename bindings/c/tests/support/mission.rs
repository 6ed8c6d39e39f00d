//! The mission of `tests/c/mission.c` with the core's own types: nothing of the C interface is used here.

use controller_core::base::{BaseController, BaseParams, Order, Sensed, WheelAction};
use controller_core::hal::{ErrorKind, WheelCounts};
use controller_core::localiser::Fix;
use controller_core::reference::Reference;
use controller_core::safety::Currents;
use controller_core::safety::supervisor::{Action, Cause, Event, State};
use controller_core::types::{Accel, Pose, Twist, WheelTorques};
use protocol::BaseTick;

const DT: f32 = 0.01;
const MASS: f32 = 10.0;
const INERTIA: f32 = 0.3;
const RADIUS: f32 = 0.075;
const HALF_TRACK: f32 = 0.175;
const COUNTS_PER_RAD: f32 = 325.9493;
const CYCLE: u32 = 6000;

#[derive(Default)]
struct Plant {
    v: f32,
    w: f32,
    right: (f32, i32),
    left: (f32, i32),
}

impl Plant {
    fn advance(&mut self, action: &WheelAction<f32>) {
        match action.torques() {
            Some(WheelTorques { right, left }) => {
                let force = (right + left) / RADIUS;
                let moment = (right - left) * HALF_TRACK / RADIUS;
                self.v += force / MASS * DT;
                self.w += moment / INERTIA * DT;
            }
            None => {
                let kept = if *action == WheelAction::Brake {
                    0.8
                } else {
                    0.97
                };
                self.v *= kept;
                self.w *= kept;
            }
        }
        let (v, w) = (self.v, self.w);
        let count = |(part, counts): &mut (f32, i32), speed: f32| {
            let moved = *part + speed * DT * COUNTS_PER_RAD;
            let whole = moved as i32;
            *part = moved - whole as f32;
            *counts = counts.wrapping_add(whole);
        };
        count(&mut self.right, (v + w * HALF_TRACK) / RADIUS);
        count(&mut self.left, (v - w * HALF_TRACK) / RADIUS);
    }
}

struct Seed(u32);

impl Seed {
    fn draw(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0 >> 8
    }

    fn noise(&mut self) -> f32 {
        self.draw() as f32 / 8_388_608.0 - 1.0
    }
}

fn order_at(cycle: u32, at: u32) -> Order<f32> {
    let goals = [
        (1.0, 0.3, 0.5),
        (-0.5, 1.0, 3.0),
        (0.2, -0.7, -1.5),
        (1.5, 1.5, 0.0),
    ];
    match at {
        12..2000 => {
            let (x, y, theta) = goals[(cycle % 4) as usize];
            Order::Park(Pose::new(x, y, theta))
        }
        2000..2600 => Order::Drive {
            twist: Twist::new(0.4, 0.001 * (at as f32 - 2300.0)),
            hold_heading: cycle % 2 == 1,
        },
        2600..4000 => Order::Park(Pose::default()),
        4000..5000 => {
            let t = (at as f32 - 4000.0) * DT;
            let rest = 4.0 - t;
            let (x, v, accel) = if t < 2.0 {
                (0.125 * t * t, 0.25 * t, 0.25)
            } else if t < 4.0 {
                (1.0 - 0.125 * rest * rest, 0.25 * rest, -0.25)
            } else {
                (1.0, 0.0, 0.0)
            };
            let pose = Pose::new(x, 0.03, 0.0);
            let reference = Reference::new(pose, Twist::new(v, 0.0), Accel::new(accel, 0.0));
            Order::Follow(reference.with_left(1.0 - x))
        }
        5000..5400 => Order::Park(Pose::new(4.5, 0.0, 0.0)),
        5460..5800 => Order::Drive {
            twist: Twist::new(-0.3, 0.0),
            hold_heading: false,
        },
        _ => Order::None,
    }
}

/// What the C program prints.
pub fn run(params: &BaseParams<f32>, ticks: u32) -> String {
    let valid = params.validate().expect("a robot");
    let mut base: BaseController = BaseController::new(&valid, Pose::default());
    let mut plant = Plant::default();
    let mut seed = Seed(1);
    let mut answer = Ok(());
    let mut pose = Pose::default();
    let mut hash = Hash(0xCBF2_9CE4_8422_2325);
    let (mut parked, mut states, mut faults, mut refused) = (0, 0_u32, 0, 0);
    for tick in 0..ticks {
        let (cycle, at) = (tick / CYCLE, tick % CYCLE);
        let mut sensed = Sensed::of_counts(WheelCounts {
            right: plant.right.1,
            left: plant.left.1,
        });
        sensed.supply_v = Some(23.0 + 0.5 * seed.noise());
        let dt_us = 10_000 + seed.draw() % 400;
        if cycle % 3 == 2 {
            let right = 2.0 * seed.noise();
            let left = 2.0 * seed.noise();
            sensed.currents = Some(Currents { right, left });
        }
        if tick % 5 == 4 {
            let mut near = |value: f32| value + 0.002 * seed.noise();
            let pose = Pose::new(near(pose.x), near(pose.y), near(pose.theta));
            sensed.fix = Some(Fix { pose, age_s: 0.02 });
        }
        sensed.driver = match (at, cycle % 4) {
            (5650, 1) => Err(ErrorKind::OverCurrent),
            _ => answer,
        };
        if (5650..5670).contains(&at) && cycle % 4 == 2 {
            sensed.counts = Err(ErrorKind::Bus);
        }
        if (5650..5780).contains(&at) && cycle % 4 == 3 {
            sensed.fix = None;
        }
        let event = match at {
            0 | 5450 => Some(Event::Reset),
            10 | 5460 => Some(Event::Arm),
            5400 | 5900 => Some(Event::Stop),
            _ => None,
        };
        if let Some(event) = event
            && base.on(event) == Action::Refuse
        {
            refused += 1;
        }
        if at == 4500 && cycle % 5 == 4 {
            let action = base.emergency_stop_by(cycle % 2 == 1);
            hash.action(&action, [0.0; 2], 0);
        }
        if at == 5990 {
            base.set_pose(Pose::default()).expect("a pose");
        }
        let action = base.tick(dt_us, &order_at(cycle, at), &sensed).action;
        let (duties, flags, exerted) = duties(&valid, &action, sensed.supply_v);
        answer = Ok(());
        if let Some(exerted) = exerted {
            base.note_exerted(&exerted).expect("finite torques");
        }
        hash.action(&action, duties, flags);
        let supervisor = base.supervisor();
        let (ignored, _) = supervisor.ignored();
        let report = base.report();
        let words = BaseTick::of(tick + 1, report, ignored);
        let state = supervisor.state();
        let number = State::ALL.iter().position(|one| *one == state);
        let number = number.expect("a state") as u32;
        let code = |fault: Option<controller_core::safety::Fault>| {
            fault.map_or(0, |fault| u32::from(fault.kind().code()))
        };
        let (cause, cause_fault) = match supervisor.cause() {
            Cause::PowerOn => (0, None),
            Cause::Host => (1, None),
            Cause::References => (2, None),
            Cause::TrajectoryEnded => (3, None),
            Cause::Reached => (4, None),
            Cause::GoalUnreachable => (5, None),
            Cause::LinkLost => (6, None),
            Cause::EmergencyStop => (7, None),
            Cause::Demanded => (8, None),
            Cause::Fault(fault) => (9, Some(fault)),
            other => panic!("no number for {other:?}"),
        };
        hash.words(&[
            words.tick,
            number,
            cause,
            code(cause_fault),
            code(supervisor.latched()),
            words.active_faults,
            ignored,
            supervisor.changes(),
            base.late_ticks(),
            u32::from(words.flags) | u32::from(report.refused) << 16,
            words.outcome as u32,
            u32::from(words.retries),
            words.action as u32,
        ]);
        hash.reals(&[words.x, words.y, words.theta, words.v, words.w]);
        hash.reals(&[words.e_x, words.e_y, words.e_theta, words.v_c, words.w_c]);
        hash.reals(&[words.e_v, words.e_w, words.load_force, words.load_moment]);
        hash.reals(&[
            words.tau_right,
            words.tau_left,
            report.curvature_bias,
            report.turn_bias,
            report.tyre_slip,
            report.motor_bias,
            0.0,
            0.0,
        ]);
        pose = Pose::new(words.x, words.y, words.theta);
        states |= 1 << number;
        faults |= words.active_faults;
        parked += u32::from(state == State::Parked);
        plant.advance(&action);
    }
    let Hash(hash) = hash;
    format!(
        "hash {hash:016x} parked {parked} states {states:x} faults {faults:x} refused {refused} error 0"
    )
}

/// What motors on bridges are driven with, and what they exert if that is less than the command; as `firmware_demo::control` has it.
fn duties(
    base: &controller_core::base::ValidBaseParams<f32>,
    action: &WheelAction<f32>,
    supply_v: Option<f32>,
) -> ([f32; 2], u32, Option<WheelTorques<f32>>) {
    let WheelAction::Drive(drive) = action else {
        return ([0.0; 2], 0, None);
    };
    let motor = base.motor().expect("motors on bridges");
    let commands = motor.commands(&drive.torques, &drive.observed(supply_v));
    assert!(!commands.is_invalid());
    let exerted = commands.exerted();
    let limited = if exerted.is_some() { 2 } else { 0 };
    let duties = [commands.right.duty, commands.left.duty];
    (duties, 1 | limited, exerted)
}

struct Hash(u64);

impl Hash {
    fn words(&mut self, words: &[u32]) {
        for word in words {
            self.0 = (self.0 ^ u64::from(*word)).wrapping_mul(0x100_0000_01B3);
        }
    }

    fn reals(&mut self, reals: &[f32]) {
        for real in reals {
            self.words(&[real.to_bits()]);
        }
    }

    fn action(&mut self, action: &WheelAction<f32>, duties: [f32; 2], flags: u32) {
        let (kind, drive) = match action {
            WheelAction::Release => (0, Default::default()),
            WheelAction::Brake => (1, Default::default()),
            WheelAction::Drive(drive) => (2, *drive),
        };
        let beyond = drive.beyond_coulomb;
        self.words(&[kind, flags | beyond.map_or(0, |_| 4)]);
        let beyond = beyond.unwrap_or_default();
        self.reals(&[drive.torques.right, drive.torques.left]);
        self.reals(&duties);
        self.reals(&[drive.desired.right, drive.desired.left]);
        self.reals(&[drive.speeds.right, drive.speeds.left]);
        self.reals(&[beyond.right, beyond.left]);
    }
}
