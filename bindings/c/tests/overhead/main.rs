//! Executed instructions of a tick: the core called from Rust, and the same through the C interface, on the same inputs.
#![no_std]
#![no_main]

use core::hint::black_box;

use capi::abi::{Action, Order, Pose, Sensed, sensed};
use capi::calls::{twb_arm, twb_init, twb_tick};
use capi::memory::{self, Base};
use controller_core::base::{self, BaseController, WheelAction};
use controller_core::hal::{Observed, WheelCounts};
use controller_core::motor::WheelCommands;
use controller_core::safety::supervisor::Event;
use controller_core::types;
use firmware_demo::board::print::Line;
use firmware_demo::board::{Meter, Spread, semihosting};
use firmware_demo::robots::LAB_10KG;
use protocol::{MAX_ROBOT_BLOB, encode_robot};

firmware_demo::firmware!(run);

#[repr(C, align(8))]
struct Memory([u8; memory::SIZE]);

type Tick = unsafe extern "C" fn(*mut Base, u32, *const Order, *const Sensed, *mut Action) -> i32;

/// What a driver of motors on bridges does with an action.
fn drive(controller: &mut BaseController, supply_v: Option<f32>) -> Option<WheelCommands> {
    let WheelAction::Drive(drive) = controller.report().action else {
        return None;
    };
    let motor = controller.base().motor()?;
    let observed = Observed {
        speeds: drive.speeds,
        desired: drive.desired,
        beyond_coulomb: drive.beyond_coulomb,
        supply_v: supply_v.unwrap_or(f32::NAN),
    };
    let commands = motor.commands(&drive.torques, &observed);
    if let Some(exerted) = commands.exerted() {
        let _ = controller.note_exerted(&exerted);
    }
    Some(commands)
}

fn run() {
    let mut blob = [0; MAX_ROBOT_BLOB];
    let (Ok(params), Some(blob)) = (
        LAB_10KG.base.validate(),
        encode_robot(&LAB_10KG.base, &mut blob),
    ) else {
        semihosting::exit(9)
    };
    let mut controller: BaseController = BaseController::new(&params, types::Pose::default());
    let mut memory = Memory([0; memory::SIZE]);
    let c: *mut Base = (&raw mut memory).cast();
    let start = Pose::default();
    // SAFETY: memory of that size and alignment, and pointers to what lives as long.
    let made = unsafe {
        twb_init(
            c,
            memory::SIZE,
            capi::abi::API,
            blob.as_ptr(),
            blob.len(),
            &start,
        )
    };
    let mut meter = Meter::start();
    let (mut rust, mut through_c, mut more) = (Spread::new(), Spread::new(), Spread::new());
    let (mut speed, mut way) = (0.0_f32, 0.0_f32);
    let mut wrong = u32::from(made != 0);
    for tick in 0..3000_u32 {
        if tick == 10 {
            controller.on(Event::Arm);
            // SAFETY: as above.
            wrong += u32::from(unsafe { twb_arm(c) } != 0);
        }
        let counts = (way / 0.075 * 325.9493) as i32;
        let mut native = base::Sensed::of_counts(WheelCounts {
            right: counts,
            left: counts,
        });
        native.supply_v = Some(24.0);
        let mut foreign = Sensed {
            right: counts,
            left: counts,
            flags: sensed::SUPPLY,
            supply_v: 24.0,
            ..Sensed::default()
        };
        if tick % 5 == 0 {
            native.fix = Some(controller_core::localiser::Fix {
                pose: types::Pose::new(way, 0.0, 0.0),
                age_s: 0.0,
            });
            foreign.flags |= sensed::FIX;
            foreign.fix = Pose {
                x: way,
                ..Pose::default()
            };
        }
        let (native_order, kind) = match tick {
            0..11 => (base::Order::None, 0),
            11..1500 => (base::Order::Park(types::Pose::new(1.0, 0.0, 0.0)), 2),
            _ => (
                base::Order::Drive {
                    twist: types::Twist::new(0.3, 0.0),
                    hold_heading: false,
                },
                3,
            ),
        };
        let mut order = Order {
            kind,
            ..Order::default()
        };
        order.pose.x = 1.0;
        order.twist.v = 0.3;
        let mut commands = None;
        let ((), native_cost) = meter.measure(|| {
            controller.tick(10_000, &native_order, &native);
            commands = drive(&mut controller, native.supply_v);
        });
        let call = black_box(twb_tick as Tick);
        let mut action = Action::default();
        let mut status = 0;
        let ((), c_cost) = meter.measure(|| {
            // SAFETY: as above.
            status = unsafe { call(c, 10_000, &order, &foreign, &mut action) };
        });
        let same = match (&controller.report().action, &commands) {
            (WheelAction::Drive(drive), Some(commands)) => {
                action.kind == 2
                    && action.torque.right.to_bits() == drive.torques.right.to_bits()
                    && action.duty.left.to_bits() == commands.left.duty.to_bits()
            }
            _ => action.kind < 2,
        };
        wrong += u32::from(status != 0 || !same);
        rust.add(native_cost);
        through_c.add(c_cost);
        more.add(c_cost.saturating_sub(native_cost));
        let force = (action.torque.right + action.torque.left) / 0.075;
        speed += force / 10.0 * 0.01;
        way += speed * 0.01;
    }
    rust.print("rust");
    through_c.print("c");
    more.print("more");
    Line::new().text("wrong").number(wrong).print();
}
