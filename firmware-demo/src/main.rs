//! The control task on the host, with wheels that only remember: what is applied to them, phase by phase.
#![cfg_attr(target_os = "none", no_std, no_main)]

// Nothing to show on a chip: `robot` is the program for that.
#[cfg(target_os = "none")]
firmware_demo::firmware!(nothing);

#[cfg(target_os = "none")]
fn nothing() {}

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    demo::run()
}

#[cfg(not(target_os = "none"))]
mod demo {
    use std::error::Error;

    use controller_core::base::{BaseController, Sensed, WheelAction};
    use controller_core::maths::Single;
    use controller_core::paper::params::Params;
    use controller_core::queue::{ReferenceProducer, ReferenceQueue, TimedReference};
    use controller_core::reference::{ConstantTwist, Reference};
    use controller_core::types::{Accel, Measured, Pose, Twist};
    use firmware_demo::control::ControlTask;
    use firmware_demo::control_server::Queues;
    use firmware_demo::drive::{MockDrive, Script};
    use firmware_demo::mission::{Encoders, PERIOD_US, params};
    use firmware_demo::model::Model;
    use protocol::{Command, RejectReason, WirePose};

    /// The task, its wheels and a robot model that moves with the torques applied.
    struct Bench<'queue> {
        task: ControlTask<'queue, MockDrive>,
        references: ReferenceProducer<'queue, f32>,
        model: Model,
        encoders: Encoders,
        now_us: u32,
        changes: u32,
    }

    /// Shows a mission, a trajectory that is cut off, a host that falls silent and a driver that fails.
    pub fn run() -> Result<(), Box<dyn Error>> {
        let mut queue = ReferenceQueue::<f32, 64>::new();
        let (references, consumer) = queue.split();
        let wheels = MockDrive::new(15.0);
        let start = Pose::new(0.0, 0.3, 0.0);
        let state = Measured {
            pose: start,
            ..Measured::default()
        };
        let mut bench = Bench {
            task: ControlTask::new(wheels, consumer, params(15.0, false)?, start)?,
            references,
            model: Model::new(Params::paper().validate()?, state),
            encoders: Encoders::default(),
            now_us: 0,
            changes: u32::MAX,
        };
        println!("      t  state             right N m  left N m       x      y  theta    v m/s");

        bench.title("armed, a curve with its end at rest, then parking");
        bench.run(5)?;
        bench.send(Command::Arm)?;
        bench.run(100)?;
        bench.curve(36, true)?;
        bench.run(9000)?;

        bench.title("parking at a pose ahead");
        let Pose { x, y, theta } = bench.model.measured().pose;
        let goal = WirePose {
            x: x + theta.cos(),
            y: y + theta.sin(),
            theta,
        };
        bench.send(Command::Park { goal })?;
        bench.run(9000)?;

        bench.title("a trajectory that is cut off: controlled stop");
        bench.send(Command::Arm)?;
        bench.curve(12, false)?;
        bench.run(4500)?;

        bench.title("a host that falls silent: a controlled stop within 100 ms");
        bench.send(Command::Arm)?;
        bench.curve(60, false)?;
        bench.run(600)?;
        bench.silence(3000);

        bench.title("the button: braked at once, until it is reset");
        bench.send(Command::Arm)?;
        bench.curve(60, false)?;
        bench.run(600)?;
        bench.send(Command::EmergencyStop { brake: true })?;
        bench.run(6000)?;
        bench.send(Command::ResetFault)?;
        bench.run(5)?;

        bench.title("a driver that fails: released at once, until the fault is reset");
        bench.send(Command::Arm)?;
        bench.curve(60, false)?;
        bench.run(400)?;
        let script = Script {
            from: 0,
            count: 1,
            kind: None,
        };
        bench.task.drive_mut().fail(script);
        bench.run(200)?;
        bench.send(Command::ResetFault)?;
        bench.run(5)?;
        sizes();
        Ok(())
    }

    impl Bench<'_> {
        fn title(&self, title: &str) {
            println!("\n{title}");
        }

        fn send(&mut self, command: Command) -> Result<(), RejectReason> {
            self.task.command(&command)
        }

        /// Samples every 0.1 s from where the robot is, its lateral offset aside.
        fn curve(&mut self, samples: u16, rest: bool) -> Result<(), Box<dyn Error>> {
            let start = self.model.measured().pose;
            let path = ConstantTwist {
                start: Pose::new(start.x, start.y - 0.1, start.theta),
                twist: Twist::new(0.4, 0.15),
            };
            self.references.restart();
            let end = f32::from(samples.saturating_sub(1)) * 0.1;
            for number in 0..samples {
                let t = f32::from(number) * 0.1;
                // To end at rest the last second is driven at a speed that falls to 0 in equal steps.
                let left = end - t;
                let (passed, speed, slowing) = if rest && left < 1.0 {
                    (end - 0.5 - 0.5 * left * left, left, -1.0)
                } else {
                    (t, 1.0, 0.0)
                };
                let reference = Reference::new(
                    *path.at::<Single>(passed).pose(),
                    Twist::new(path.twist.linear * speed, path.twist.angular * speed),
                    Accel::new(path.twist.linear * slowing, path.twist.angular * slowing),
                );
                self.references
                    .push(TimedReference { t, reference })
                    .map_err(|error| error.to_string())?;
            }
            Ok(())
        }

        /// Runs with a host that says something every 20 ms.
        fn run(&mut self, ticks: u32) -> Result<(), RejectReason> {
            for tick in 0..ticks {
                if tick % 20 == 0 {
                    self.send(Command::Heartbeat)?;
                }
                self.tick();
            }
            Ok(())
        }

        fn silence(&mut self, ticks: u32) {
            for _ in 0..ticks {
                self.tick();
            }
        }

        fn tick(&mut self) {
            self.now_us = self.now_us.wrapping_add(PERIOD_US);
            let dt = PERIOD_US as f32 * 1e-6;
            self.model.act(dt, self.task.output());
            let counts = self.encoders.advance(dt, &self.model);
            self.task.tick(self.now_us, &Sensed::of_counts(counts));
            let changed = self.task.changes() != self.changes;
            let shown = self.task.state().drives() && self.now_us.is_multiple_of(500_000);
            if changed || shown {
                self.changes = self.task.changes();
                self.print(changed);
            }
        }

        fn print(&mut self, changed: bool) {
            let Measured { pose, twist } = *self.model.measured();
            let state = format!("{:?}", self.task.state());
            let wheels = match self.task.output() {
                WheelAction::Drive(drive) => {
                    let applied = &drive.torques;
                    format!("{:9.3} {:9.3}", applied.right, applied.left)
                }
                WheelAction::Brake => format!("{:>19}", "braked"),
                WheelAction::Release => format!("{:>19}", "released"),
            };
            let cause = if changed {
                format!("  <- {:?}", self.task.cause())
            } else {
                String::new()
            };
            println!(
                "{:7.3}  {state:17} {wheels}  {:6.3} {:6.3} {:6.3}  {:7.3}{cause}",
                f64::from(self.now_us) * 1e-6,
                pose.x,
                pose.y,
                pose.theta,
                twist.linear,
            );
        }
    }

    fn sizes() {
        println!("\nBytes of state on this machine (no heap)");
        for (name, bytes) in [
            ("base, with its parameters", size_of::<BaseController>()),
            (
                "control task, with base",
                size_of::<ControlTask<'_, MockDrive<0>>>(),
            ),
            (
                "queues for samples, commands, telemetry",
                size_of::<Queues>(),
            ),
        ] {
            println!("{bytes:7}  {name}");
        }
    }
}
