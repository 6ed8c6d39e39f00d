//! The host's side: runs an image in the emulator, counting, and gives its rows. Tests of budgets take it as it is.

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use controller_core::maths::Single;
use controller_core::paper::demand::Demand;
use controller_core::paper::params::Params;
use controller_core::reference::ConstantTwist;
use controller_core::types::{Measured, Pose, Twist};
use firmware_demo::host::{Chip, Emulator, LinkKind, Machine, Options};

/// How to call it.
pub const USAGE: &str = "usage: cost arm|riscv cost|pil IMAGE";

/// Control period \[s\].
const DT: f32 = 1.0e-3;
/// Ticks per phase.
const TICKS: u32 = 1000;
/// Longer than any run; a hung image is killed.
const LIMIT: Duration = Duration::from_secs(120);

/// What `cost arm cost IMAGE` and the like print.
pub fn run(arguments: &[&str]) -> Result<String, Box<dyn Error>> {
    let &[machine, program, image] = arguments else {
        return Err(USAGE.into());
    };
    let machine = match machine {
        "arm" => Machine::CortexM4F,
        "riscv" => Machine::Riscv32,
        _ => return Err(USAGE.into()),
    };
    let options = Options {
        machine,
        link: LinkKind::None,
        icount: true,
        core: None,
        silence: LIMIT,
    };
    match program {
        "cost" => count(Path::new(image), &options),
        "pil" => close_the_loop(Path::new(image), &options),
        _ => Err(USAGE.into()),
    }
}

/// The image counts; its lines are passed on.
fn count(image: &Path, options: &Options) -> Result<String, Box<dyn Error>> {
    let (emulator, _) = Emulator::start(image, options)?;
    let outcome = emulator.finish(LIMIT)?;
    match outcome.code {
        Some(0) => Ok(outcome.console),
        code => Err(format!("the image ended with {code:?}:\n{}", outcome.console).into()),
    }
}

/// The least, the sum and the most of a row.
struct Row(u32, u64, u32, u32);

impl Row {
    const fn new() -> Self {
        Self(u32::MAX, 0, 0, 0)
    }

    fn add(&mut self, value: u32) {
        self.0 = self.0.min(value);
        self.1 += u64::from(value);
        self.2 = self.2.max(value);
        self.3 += 1;
    }

    fn line(&self, name: &str) -> String {
        let mean = self.1 as f64 / f64::from(self.3.max(1));
        format!("pil/{name} {} {mean:.2} {}\n", self.0, self.2)
    }
}

/// The processor in the loop, with a robot that moves with the torques of the tick before.
fn close_the_loop(image: &Path, options: &Options) -> Result<String, Box<dyn Error>> {
    let link = LinkKind::Fifo;
    let mut chip = Chip::start_image(image, &Options { link, ..*options })?;
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
    let (mut track, mut hand_over, mut park) = (Row::new(), Row::new(), Row::new());
    for tick in 1..=2 * TICKS {
        let reference = path.at::<Single>(tick as f32 * DT);
        let (row, demand) = if tick < TICKS {
            (&mut track, Demand::Track(reference))
        } else if tick == TICKS {
            let goal = *path.at::<Single>(1.5 * TICKS as f32 * DT).pose();
            (&mut hand_over, Demand::HandOver { reference, goal })
        } else {
            (&mut park, Demand::Park)
        };
        let ticked = chip.tick(DT, &demand, &measured)?;
        row.add(ticked.instructions);
        let (pose, twist) = (&mut measured.pose, ticked.report.command);
        pose.x += twist.linear * DT * pose.theta.cos();
        pose.y += twist.linear * DT * pose.theta.sin();
        pose.theta += twist.angular * DT;
        measured.twist = twist;
    }
    let stack = format!("stack/pil {}\n", chip.counters()?.stack_bytes);
    chip.finish()?;
    let rows = [
        track.line("track"),
        hand_over.line("hand-over"),
        park.line("park"),
        stack,
    ];
    Ok(rows.concat())
}
