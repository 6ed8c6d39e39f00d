//! Measures ticks per second against an emulated chip: `exchange [arm|riscv] [fifo|uart] [count] [core] [icount]`.

use std::error::Error;
use std::time::{Duration, Instant};

use controller_core::maths::Single;
use controller_core::paper::demand::Demand;
use controller_core::paper::params::Params;
use controller_core::reference::ConstantTwist;
use controller_core::types::{Measured, Pose, Twist};
use firmware_demo::host::{Chip, LinkKind, Machine, Options};

const DT: f32 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |at: usize| arguments.get(at).map_or("", String::as_str);
    let count: u32 = argument(2).parse().unwrap_or(1000);
    let mut chip = Chip::start(&Options {
        machine: if argument(0) == "riscv" {
            Machine::Riscv32
        } else {
            Machine::CortexM4F
        },
        link: if argument(1) == "uart" {
            LinkKind::Uart
        } else {
            LinkKind::Fifo
        },
        icount: argument(4) == "icount",
        core: argument(3).parse().ok(),
        silence: Duration::from_secs(5),
    })?;

    // A robot that follows the command of the tick before, so that the loop is closed.
    let path = ConstantTwist {
        start: Pose::default(),
        twist: Twist::new(0.4, 0.15),
    };
    let mut measured = Measured {
        pose: Pose::new(0.0, 0.2, 0.1),
        ..Measured::default()
    };
    chip.configure(&Params::paper())?;
    chip.begin(&path.at::<Single>(0.0), &measured)?;
    let (mut least, mut most) = (u32::MAX, 0);
    let start = Instant::now();
    for tick in 1..=count {
        let demand = Demand::Track(path.at::<Single>(tick as f32 * DT));
        let ticked = chip.tick(DT, &demand, &measured)?;
        least = least.min(ticked.instructions);
        most = most.max(ticked.instructions);
        let (pose, twist) = (&mut measured.pose, ticked.report.command);
        pose.x += twist.linear * DT * pose.theta.cos();
        pose.y += twist.linear * DT * pose.theta.sin();
        pose.theta += twist.angular * DT;
        measured.twist = twist;
    }
    let rate = f64::from(count) / start.elapsed().as_secs_f64();
    println!("{rate:.0} ticks/s, {least} to {most} instructions");
    println!("{:?}", chip.counters()?);
    println!("{:?}", chip.finish()?);
    Ok(())
}
