//! Random missions: a base that is pushed around, uneven ticks, refused ones, parameters far from the paper's.

use super::{Compared, MACHINES, Work, compare, start};
use controller_core::maths::Single;
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::Params;
use controller_core::paper::params::Reset;
use controller_core::paper::report::StepReport;
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::types::{Measured, Pose, Twist};
use firmware_demo::host::{Chip, ChipError, LinkKind, Machine};
use protocol::RejectReason;
use protocol::pil::{Refusal, Ticked};
use sim_host::pil::{Parity, pairs};

const DT: f32 = 1e-3;

/// Reproducible numbers (xorshift32).
struct Random(u32);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// In [low, high).
    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() >> 8) as f32 * (1.0 / 16_777_216.0)
    }
}

/// Both sides of a tick.
fn note(parity: &mut Parity, chip: &Ticked, host: &Ticked) {
    assert_eq!(chip.tick, host.tick);
    assert_eq!(chip.hand_over_step.is_some(), host.hand_over_step.is_some());
    parity.compare(host.tick, pairs(chip, host));
}

/// A base that does what the torques say, pushed around at random.
struct Base {
    measured: Measured<f32>,
    params: Params<f32>,
    random: Random,
}

impl Base {
    fn advance(&mut self, report: &StepReport<f32>, dt: f32) {
        let Measured { pose, twist } = &mut self.measured;
        let wheels = &self.params.robot.wheels;
        let right = report.torques.right / wheels.radius_right_m;
        let left = report.torques.left / wheels.radius_left_m;
        let push = self.random.within(-20.0, 20.0);
        let turn = self.random.within(-10.0, 10.0);
        twist.linear += dt * (right + left + push) / self.params.robot.mass_kg;
        let moment = 0.5 * wheels.track_m * (right - left) + turn;
        twist.angular += dt * moment / self.params.robot.inertia_kg_m2;
        pose.x += dt * twist.linear * pose.theta.cos();
        pose.y += dt * twist.linear * pose.theta.sin();
        pose.theta += dt * twist.angular;
    }
}

/// One mission on both: tracking, a refused tick now and then, hand-over, parking. Returns refused ticks.
fn mission(
    chip: &mut Chip,
    parity: &mut Parity,
    params: Params<f32>,
    seed: u32,
    ticks: u32,
) -> u32 {
    let mut random = Random(seed);
    let path = ConstantTwist {
        start: Pose::new(0.0, 0.0, random.within(-3.0, 3.0)),
        twist: Twist::new(random.within(-0.2, 0.8), random.within(-0.5, 0.5)),
    };
    let mut base = Base {
        measured: Measured {
            pose: Pose::new(
                random.within(-1.0, 1.0),
                random.within(-1.0, 1.0),
                random.within(-7.0, 7.0),
            ),
            twist: Twist::new(random.within(-0.3, 0.3), random.within(-0.3, 0.3)),
        },
        params,
        random: Random(seed ^ 0x5555),
    };
    let valid = params.validate().unwrap();
    chip.configure(&params).unwrap();

    let reference = path.at::<Single>(0.0);
    let mut local: NeuralController =
        NeuralController::start(&valid, &reference, &base.measured).unwrap();
    let remote = chip.begin(&reference, &base.measured).unwrap();
    note(parity, &remote, &Ticked::of(&local, false));

    let hand_over = ticks * 3 / 5;
    let (mut good, mut refused) = (0, 0);
    for tick in 1..=ticks {
        let reference = path.at::<Single>(tick as f32 * DT);
        let goal = Pose::new(1.0, 0.5, 0.3);
        let mut demand = match tick {
            tick if tick < hand_over => Demand::Track(reference),
            tick if tick == hand_over => Demand::HandOver { reference, goal },
            _ => Demand::Park,
        };
        let mut measured = base.measured;
        let mut dt = DT * base.random.within(0.5, 1.5);
        match base.random.bits() % 50 {
            0 if tick != hand_over => measured.pose.y = f32::NAN,
            1 if tick != hand_over => measured.twist.angular = f32::INFINITY,
            2 if tick != hand_over => dt = 0.0,
            3 if tick != hand_over => dt = 1.0,
            4 if tick < hand_over => demand = Demand::Park,
            5 if tick > hand_over => demand = Demand::Track(reference),
            _ => {}
        }
        let handed_over = matches!(demand, Demand::HandOver { .. });
        match (
            local.step(dt, &demand, &measured),
            chip.tick(dt, &demand, &measured),
        ) {
            (Ok(_), Ok(remote)) => {
                good += 1;
                let expected = Ticked {
                    tick: good,
                    ..Ticked::of(&local, handed_over)
                };
                note(parity, &remote, &expected);
                assert!(parity.is_exact(), "tick {tick}, seed {seed}: {parity:?}");
                assert_eq!(remote.hand_over_step.is_some(), handed_over);
                base.advance(&remote.report, dt);
            }
            (Err(fault), Err(ChipError::Refused(refusal))) => {
                refused += 1;
                assert_eq!(Refusal::from(fault), refusal, "tick {tick}, seed {seed}");
            }
            other => panic!("tick {tick}, seed {seed}: {other:?}"),
        }
    }
    refused
}

/// Parameters far from the paper's: unequal wheels, unequal gains, a low torque limit, the printed reset.
fn others() -> Params<f32> {
    let mut params = Params::paper();
    params.robot.mass_kg = 7.3;
    params.robot.wheels.radius_left_m = 0.093;
    params.tracking.k2 = 11.0;
    params.parking.k_c1 = 31.0;
    params.neurons.b = 0.7;
    params.neurons.d = 1.3;
    params.reset = Reset::Printed;
    params.max_wheel_torque_nm = Some(0.8);
    params
}

/// Both sets of parameters, half of the ticks each, and parameters that are refused without change.
pub(super) fn fly(chip: &mut Chip, ticks: u32) -> Compared {
    let (reference, measured) = (Reference::at_rest(Pose::default()), Measured::default());
    let early = chip.tick(DT, &Demand::Track(reference), &measured);
    assert!(matches!(
        early,
        Err(ChipError::Rejected(RejectReason::State))
    ));

    let mut parity = Parity::default();
    let mut refused = mission(chip, &mut parity, Params::paper(), 1, ticks / 2);
    refused += mission(chip, &mut parity, others(), 2, ticks - ticks / 2);
    assert!(refused > 0, "no refused tick was tried");

    let mut wrong = Params::paper();
    wrong.tracking.k3 = f32::NAN;
    let answer = chip.configure(&wrong);
    assert!(matches!(
        answer,
        Err(ChipError::Rejected(RejectReason::Value))
    ));
    // Refused without change: the parameters of before still make the same bits.
    let valid = others().validate().unwrap();
    let local: NeuralController = NeuralController::start(&valid, &reference, &measured).unwrap();
    let remote = chip.begin(&reference, &measured).unwrap();
    note(&mut parity, &remote, &Ticked::of(&local, false));
    Compared {
        parity,
        ..Compared::default()
    }
}

#[test]
fn cortex_m4f_computes_the_same_bits() {
    compare(
        Machine::CortexM4F,
        LinkKind::Fifo,
        false,
        &Work::Missions(2000),
    );
}

#[test]
fn riscv_computes_the_same_bits() {
    compare(
        Machine::Riscv32,
        LinkKind::Fifo,
        false,
        &Work::Missions(300),
    );
}

#[test]
fn serial_port_carries_every_bit() {
    for machine in MACHINES {
        compare(machine, LinkKind::Uart, false, &Work::Missions(100));
    }
}

/// The counter sees the step alone: nearly the same number in every tick of a phase, and about what the step
/// costs by itself. The gate on that cost is not here.
#[test]
fn instructions_are_those_of_the_step() {
    for (machine, most) in [(Machine::CortexM4F, 330), (Machine::Riscv32, 440)] {
        let mut chip = start(machine, LinkKind::Fifo, true);
        let reference = Reference::at_rest(Pose::new(0.3, 0.2, 0.1));
        let mut measured = Measured::default();
        chip.begin(&reference, &measured).unwrap();
        for demand in [
            Demand::Track(reference),
            Demand::HandOver {
                reference,
                goal: Pose::default(),
            },
            Demand::Park,
        ] {
            let mut counts = (0..5).map_while(|_| {
                measured.pose.x += 0.001;
                let ticked = chip.tick(DT, &demand, &measured).ok()?;
                Some(ticked.instructions)
            });
            let first = counts.next().unwrap();
            if !matches!(demand, Demand::HandOver { .. }) {
                assert!((150..=most).contains(&first), "{machine:?} {first}");
                for count in counts {
                    assert!(count.abs_diff(first) <= 15, "{machine:?} {first} {count}");
                }
            }
        }
        chip.finish().unwrap();
    }
}
