//! Orders, measurements and events of any kind into a whole base.

use std::sync::OnceLock;

use controller_core::base::{BaseController, Order, Sensed, ValidBaseParams, WheelAction};
use controller_core::gyro::{GyroParams, GyroReading};
use controller_core::hal::{ErrorKind, WheelCounts};
use controller_core::localiser::Fix;
use controller_core::maths::Single;
use controller_core::reference::Reference;
use controller_core::safety::supervisor::{Event, State};
use controller_core::safety::{Currents, OutputMode};
use controller_core::shunting::RationalMean;
use controller_core::types::{Accel, Pose, Twist, WheelTorques};
use sim_host::scenario::BuiltInBase;

use super::bytes::Bytes;
use super::engine::{Met, Target};

type Base = BaseController<f32, Single, RationalMean, 8>;

/// Ticks of any length, with anything measured and ordered: torques are finite, within the limit and only where the state has torque.
pub const TICKS: Target = Target {
    name: "ticks",
    run: ticks,
    seeds,
    longest: 4_000,
    words: &[],
    in_a_test: 20_000,
};

fn bases() -> &'static [ValidBaseParams<f32>] {
    static BASES: OnceLock<Vec<ValidBaseParams<f32>>> = OnceLock::new();
    BASES.get_or_init(|| {
        // Each as its file has it, and with a gyro.
        ["paper-30kg", "lab-10kg", "hobby-1kg"]
            .iter()
            .flat_map(|name| [(name, false), (name, true)])
            .map(|(name, with_gyro)| {
                let built_in = BuiltInBase::find(name).expect("built in");
                let base = built_in.base().expect("valid");
                let mut params = sim_host::closed_loop::params(&base, 10_000).expect("valid");
                if with_gyro {
                    params.localiser.gyro = Some(GyroParams::icm_42688_p());
                }
                params.validate().expect("valid")
            })
            .collect()
    })
}

/// Ordinary drives: armed, then so many ticks of an order.
fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    for base in 0..6 {
        for order in 0..4_u8 {
            let mut bytes = vec![base, TICK, 0, 0, EVENT, 0];
            for tick in 0..60_u8 {
                bytes.extend([
                    TICK,
                    0,
                    1 + order,
                    200,
                    40,
                    200,
                    20,
                    200,
                    tick,
                    200,
                    30,
                    200,
                    10,
                ]);
            }
            seeds.push(bytes);
        }
    }
    seeds
}

/// First bytes of what is done; everything else is a tick.
const TICK: u8 = 0;
const EVENT: u8 = 1;

fn pose(bytes: &mut Bytes<'_>) -> Pose<f32> {
    Pose::new(bytes.float(3.0), bytes.float(3.0), bytes.float(4.0))
}

fn twist(bytes: &mut Bytes<'_>) -> Twist<f32> {
    Twist::new(bytes.float(1.0), bytes.float(3.0))
}

fn order(bytes: &mut Bytes<'_>) -> Order<f32> {
    match bytes.byte() % 8 {
        1 | 5 => Order::Follow(Reference::new(
            pose(bytes),
            twist(bytes),
            Accel::new(bytes.float(1.0), bytes.float(1.0)),
        )),
        2 => Order::Park(pose(bytes)),
        3 | 6 => Order::Drive {
            twist: twist(bytes),
            hold_heading: bytes.byte().is_multiple_of(2),
        },
        _ => Order::None,
    }
}

fn gyro(bytes: &mut Bytes<'_>) -> GyroReading<f32> {
    GyroReading {
        rate: bytes.float(3.0),
        heading: (bytes.byte() < 64).then(|| bytes.float(4.0)),
        age_s: bytes.float(0.05),
    }
}

const ERRORS: [ErrorKind; 5] = [
    ErrorKind::Bus,
    ErrorKind::OverCurrent,
    ErrorKind::UnderVoltage,
    ErrorKind::OutOfRange,
    ErrorKind::Other,
];

fn ticks(input: &[u8], met: &mut Met) {
    let mut bytes = Bytes(input);
    let bases = bases();
    let params = &bases[usize::from(bytes.byte()) % bases.len()];
    let mut limit = params.motion().params().limits.wheel_torque_nm;
    let mut base = Base::new(params, pose(&mut bytes.clone()));
    let mut counts = WheelCounts::default();
    while let Some(kind) = bytes.take() {
        let before = base.supervisor().state();
        match kind {
            EVENT => {
                base.on(bytes.one_of(Event::ALL));
            }
            2 => {
                let action = base.emergency_stop();
                assert!(matches!(action, WheelAction::Brake | WheelAction::Release));
            }
            3 => {
                // A pose that is refused changes nothing, and neither does a torque.
                let (pose, last) = (pose(&mut bytes), base);
                let refused = base.set_pose(pose).is_err();
                assert!(refused != pose.is_near() && (!refused || same(&base, &last)));
            }
            4 => {
                let (right, left) = (bytes.float(limit), bytes.float(limit));
                let last = base;
                let noted = base.note_exerted(&WheelTorques { right, left });
                assert!(noted.is_ok() || same(&base, &last));
            }
            5 => base.frame_seen(),
            6 => base.watch_link(bytes.word() % 200_000),
            7 => {
                let params = &bases[usize::from(bytes.byte()) % bases.len()];
                if base.reconfigure(params).is_ok() {
                    limit = params.motion().params().limits.wheel_torque_nm;
                } else {
                    assert!(before.is_live());
                }
            }
            _ => {
                let (dt_us, sensed) = sense(&mut bytes, &mut counts);
                let order = order(&mut bytes);
                let report = *base.tick(dt_us, &order, &sensed);
                if let Some(torques) = report.action.torques() {
                    let within = |torque: f32| (-limit..=limit).contains(&torque);
                    assert!(within(torques.right) && within(torques.left), "{report:?}");
                    let standing =
                        matches!(report.state, State::Idle | State::Stopped | State::Fault);
                    assert!(!standing, "{report:?}");
                }
                let cut = matches!(
                    base.supervisor().output(),
                    OutputMode::Release | OutputMode::Brake
                );
                assert!(
                    !cut || report
                        .action
                        .torques()
                        .is_none_or(|t| t == WheelTorques::default())
                        || report.state == State::Parked,
                    "{report:?}"
                );
                let motion = report
                    .motion
                    .map(|motion| (motion.mode, motion.outcome, motion.limited, motion.jumped));
                met.saw((motion, std::mem::discriminant(&report.fix), report.blind));
                met.saw((before, report.state));
                for fault in report.active_faults.iter() {
                    met.saw((fault.kind(), report.state));
                }
            }
        }
    }
}

/// Equal, or both with the same NaN.
fn same(a: &Base, b: &Base) -> bool {
    a == b || format!("{a:?}") == format!("{b:?}")
}

fn sense(bytes: &mut Bytes<'_>, counts: &mut WheelCounts) -> (u32, Sensed<f32>) {
    let flags = bytes.byte();
    let dt_us = if flags & 1 != 0 {
        bytes.one_of([0, 1, 9_000, 11_000, 100_000, 600_000, 20_000_000, u32::MAX])
    } else {
        10_000
    };
    if flags & 2 != 0 {
        let wild = bytes.byte() == 0;
        let scale = if wild { 1 << 24 } else { 1 };
        counts.right = counts
            .right
            .wrapping_add(i32::from(bytes.byte() as i8).wrapping_mul(scale));
        counts.left = counts
            .left
            .wrapping_add(i32::from(bytes.byte() as i8).wrapping_mul(scale));
    }
    let sensed = Sensed {
        counts: if flags & 4 != 0 && bytes.byte() < 64 {
            Err(bytes.one_of(ERRORS))
        } else {
            Ok(*counts)
        },
        fix: (flags & 8 != 0).then(|| Fix {
            pose: pose(bytes),
            age_s: bytes.float(0.1),
        }),
        supply_v: (flags & 16 != 0).then(|| bytes.float(24.0)),
        currents: (flags & 32 != 0).then(|| Currents {
            right: bytes.float(10.0),
            left: bytes.float(10.0),
        }),
        gyro: (flags & 128 != 0).then(|| gyro(bytes)),
        driver: if flags & 64 != 0 && bytes.byte() < 32 {
            Err(bytes.one_of(ERRORS))
        } else {
            Ok(())
        },
    };
    (dt_us, sensed)
}
