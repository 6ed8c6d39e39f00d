//! Executed instructions from the sensors' numbers to the motors' duties, tick by tick: through the C interface as an object that is
//! linked, or with `--cfg in_rust` with the core's types. An image each, for in one the compiler would inline one of them.
#![no_std]
#![no_main]

use core::hint::black_box;

use controller_core::types::WheelTorques;
use firmware_demo::board::print::Line;
use firmware_demo::board::{Meter, semihosting};

firmware_demo::firmware!(run);

/// What a program has before each tick.
#[derive(Clone, Copy)]
struct Inputs {
    /// As a program measures it: a number that the compiler knew would be carried through the whole tick in Rust, and not through C.
    dt_us: u32,
    counts: [i32; 2],
    supply_v: f32,
    fix: Option<[f32; 3]>,
    demand: Demand,
}

#[derive(Clone, Copy)]
enum Demand {
    Nothing,
    Park([f32; 3]),
    Drive([f32; 2]),
}

/// Torques for the plant, and what the program is after.
#[derive(Clone, Copy, Default)]
struct Outputs {
    torques: WheelTorques<f32>,
    duties: [f32; 2],
}

#[cfg(in_rust)]
mod base {
    use controller_core::base::{BaseController, Order, Sensed, WheelAction};
    use controller_core::hal::WheelCounts;
    use controller_core::localiser::Fix;
    use controller_core::safety::supervisor::Event;
    use controller_core::types::{Pose, Twist};
    use firmware_demo::robots::LAB_10KG;

    use super::{Inputs, Outputs, Demand};

    pub type Base = BaseController;

    pub fn new() -> Option<Base> {
        let params = LAB_10KG.base.validate().ok()?;
        Some(BaseController::new(&params, Pose::default()))
    }

    pub fn arm(base: &mut Base) {
        base.on(Event::Arm);
    }

    #[inline(never)]
    pub fn tick(base: &mut Base, inputs: &Inputs, outputs: &mut Outputs) {
        let [right, left] = inputs.counts;
        let mut sensed = Sensed::of_counts(WheelCounts { right, left });
        sensed.supply_v = Some(inputs.supply_v);
        sensed.fix = inputs.fix.map(|[x, y, theta]| Fix {
            pose: Pose::new(x, y, theta),
            age_s: 0.0,
        });
        let order = match inputs.demand {
            Demand::Nothing => Order::None,
            Demand::Park([x, y, theta]) => Order::Park(Pose::new(x, y, theta)),
            Demand::Drive([v, w]) => Order::Drive {
                twist: Twist::new(v, w),
                hold_heading: false,
            },
        };
        base.tick(inputs.dt_us, &order, &sensed);
        *outputs = Outputs::default();
        let WheelAction::Drive(drive) = &base.report().action else {
            return;
        };
        outputs.torques = drive.torques;
        let Some(motor) = base.base().motor() else {
            return;
        };
        let observed = drive.observed(sensed.supply_v);
        let commands = motor.commands(&drive.torques, &observed);
        outputs.duties = [commands.right.duty, commands.left.duty];
        if let Some(exerted) = commands.exerted() {
            let _ = base.note_exerted(&exerted);
        }
    }
}

#[cfg(not(in_rust))]
mod base {
    use capi::abi::{API, Action, Order, Pose, Sensed, Twist, order, sensed};
    use capi::memory::{self, Base as Opaque};
    use controller_core::types::WheelTorques;
    use firmware_demo::robots::LAB_10KG;
    use protocol::{MAX_ROBOT_BLOB, encode_robot};

    use super::{Inputs, Outputs, Demand};

    // Of the object, by names of their own: the compiler sees no more of them than of what is behind a header.
    unsafe extern "C" {
        #[link_name = "called_init"]
        fn twb_init(
            base: *mut Opaque,
            size: usize,
            api: u32,
            robot: *const u8,
            length: usize,
            start: *const Pose,
        ) -> i32;
        #[link_name = "called_arm"]
        fn twb_arm(base: *mut Opaque) -> i32;
        #[link_name = "called_tick"]
        fn twb_tick(
            base: *mut Opaque,
            dt_us: u32,
            order: *const Order,
            sensed: *const Sensed,
            action: *mut Action,
        ) -> i32;
    }

    #[repr(C, align(8))]
    struct Memory([u8; memory::SIZE]);

    pub struct Base {
        memory: Memory,
        order: Order,
        sensed: Sensed,
        action: Action,
    }

    impl Base {
        fn pointer(&mut self) -> *mut Opaque {
            (&raw mut self.memory).cast()
        }
    }

    pub fn new() -> Option<Base> {
        let mut base = Base {
            memory: Memory([0; memory::SIZE]),
            order: Order::default(),
            sensed: Sensed::default(),
            action: Action::default(),
        };
        let mut bytes = [0; MAX_ROBOT_BLOB];
        let blob = encode_robot(&LAB_10KG.base, &mut bytes)?;
        let start = Pose::default();
        let to = base.pointer();
        // SAFETY: memory of that size and alignment, bytes of that length.
        let made = unsafe { twb_init(to, memory::SIZE, API, blob.as_ptr(), blob.len(), &start) };
        (made == 0).then_some(base)
    }

    pub fn arm(base: &mut Base) {
        // SAFETY: as above.
        unsafe { twb_arm(base.pointer()) };
    }

    #[inline(never)]
    pub fn tick(base: &mut Base, inputs: &Inputs, outputs: &mut Outputs) {
        let to = base.pointer();
        let sensed = &mut base.sensed;
        [sensed.right, sensed.left] = inputs.counts;
        sensed.supply_v = inputs.supply_v;
        sensed.flags = sensed::SUPPLY;
        if let Some([x, y, theta]) = inputs.fix {
            sensed.flags |= sensed::FIX;
            sensed.fix = Pose { x, y, theta };
        }
        match inputs.demand {
            Demand::Nothing => base.order.kind = order::NONE,
            Demand::Park([x, y, theta]) => {
                base.order.kind = order::PARK;
                base.order.pose = Pose { x, y, theta };
            }
            Demand::Drive([v, w]) => {
                base.order.kind = order::VELOCITY;
                base.order.twist = Twist { v, w };
            }
        }
        // SAFETY: as above, and pointers to fields that live as long.
        unsafe {
            twb_tick(
                to,
                inputs.dt_us,
                &base.order,
                &base.sensed,
                &mut base.action,
            )
        };
        let action = &base.action;
        outputs.torques = WheelTorques {
            right: action.torque.right,
            left: action.torque.left,
        };
        outputs.duties = [action.duty.right, action.duty.left];
    }
}

fn run() {
    let Some(mut base) = base::new() else {
        semihosting::exit(9)
    };
    let mut meter = Meter::start();
    let (mut speed, mut way) = (0.0_f32, 0.0_f32);
    for tick in 0..3000_u32 {
        if tick == 10 {
            base::arm(&mut base);
        }
        let counts = (way / 0.075 * 325.9493) as i32;
        let inputs = black_box(Inputs {
            dt_us: 10_000,
            counts: [counts, counts],
            supply_v: 24.0,
            fix: (tick % 5 == 0).then_some([way, 0.0, 0.0]),
            demand: match tick {
                0..11 => Demand::Nothing,
                11..1500 => Demand::Park([1.0, 0.0, 0.0]),
                _ => Demand::Drive([0.3, 0.0]),
            },
        });
        let mut outputs = Outputs::default();
        let ((), cost) = meter.measure(|| base::tick(&mut base, &inputs, &mut outputs));
        let Outputs { torques, duties } = outputs;
        let force = (torques.right + torques.left) / 0.075;
        speed += force / 10.0 * 0.01;
        way += speed * 0.01;
        let [right, left] = duties.map(f32::to_bits);
        let line = Line::new().text("tick").number(cost).number(right);
        line.number(left).print();
    }
}
