//! Measures closed-loop exchanges per second: `exchange [arm|riscv] [fifo|uart] [count] [core] [icount]`.

use std::error::Error;
use std::time::{Duration, Instant};

use firmware_demo::host::{Emulator, Image, LinkKind, Machine, Options, Session, build_image};
use firmware_demo::protocol::{Command, Measure, Telemetry, WirePose};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |at: usize| arguments.get(at).map_or("", String::as_str);
    let machine = if argument(0) == "riscv" {
        Machine::Riscv32
    } else {
        Machine::CortexM4F
    };
    let link = if argument(1) == "uart" {
        LinkKind::Uart
    } else {
        LinkKind::Fifo
    };
    let count: u32 = argument(2).parse().unwrap_or(1000);
    let core = argument(3).parse().ok();
    let icount = argument(4) == "icount";

    let image = build_image(&Image {
        machine,
        bin: "pil",
        features: "",
    })?;
    let options = Options {
        machine,
        link,
        icount,
        core,
        silence: Duration::from_secs(5),
    };
    let (emulator, link) = Emulator::start(&image, &options)?;
    let mut session = Session::new(link.ok_or("no link")?);
    println!("{:?}", session.ask(&Command::Heartbeat)?);

    let (mut least, mut most) = (u32::MAX, 0);
    let start = Instant::now();
    for tick in 0..count {
        let x = tick as f32 * 1e-3;
        let pose = WirePose {
            x,
            y: -x,
            theta: 0.5,
        };
        let measure = Measure {
            tick,
            dt: 1e-3,
            pose,
            ..Measure::default()
        };
        match session.ask(&Command::Measure(measure))? {
            Telemetry::Report(report) if report.tick == tick && report.e_x == -x => {
                least = least.min(report.instructions);
                most = most.max(report.instructions);
            }
            other => return Err(format!("tick {tick}: {other:?}").into()),
        }
    }
    let rate = f64::from(count) / start.elapsed().as_secs_f64();
    println!("{rate:.0} exchanges/s, counter {least} to {most}");
    println!("{:?}", session.ask(&Command::GetCounters)?);
    println!("{:?}", session.ask(&Command::Stop)?);
    println!("{:?}", emulator.finish(Duration::from_secs(5))?);
    Ok(())
}
