//! A whole robot on an emulated board: control in the timer's interrupt, commands by the serial port in the
//! background, and a model in place of motors and wheels.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(run);
#[cfg(target_os = "none")]
firmware_demo::timer_interrupt!();

#[cfg(target_os = "none")]
fn run() {
    chip::run();
}

#[cfg(target_os = "none")]
mod chip {
    use controller_core::base::Sensed;
    use controller_core::paper::params::Params;
    use controller_core::types::{Measured, Pose};
    use firmware_demo::board::{EXIT_LINK, Uart, high_water_mark, semihosting, with_ticks};
    use firmware_demo::control::ControlTask;
    use firmware_demo::control_server::{CommandReceiver, ControlServer, Queues};
    use firmware_demo::drive::MockDrive;
    use firmware_demo::line::send;
    use firmware_demo::mission::{Encoders, PERIOD_US, params};
    use firmware_demo::model::Model;
    use firmware_demo::storage::{RamFlash, Slots};

    const MAX_TORQUE_NM: f32 = 15.0;
    /// Decimation of reports: one of this many is sent, 50 a second.
    const DECIMATE: u16 = 20;

    /// Returns only when the line fails.
    pub fn run() {
        let (Ok(body), Ok(params)) = (Params::paper().validate(), params(MAX_TORQUE_NM, false))
        else {
            semihosting::exit(EXIT_LINK)
        };
        let mut queues = Queues::default();
        let (references, ends, mut receiver) = queues.split(DECIMATE);
        let wheels = MockDrive::<0>::new(MAX_TORQUE_NM);
        let Ok(task) = ControlTask::new(wheels, references, params, Pose::default()) else {
            semihosting::exit(EXIT_LINK)
        };
        let memory = Slots::new(RamFlash::default());
        let mut server = ControlServer::with_memory(task, ends, memory);
        let mut model = Model::new(body, Measured::default());
        let mut encoders = Encoders::default();
        let mut last_us = 0;
        let mut tick = move |now_us: u32| {
            // First the time that has passed, with what was applied to the wheels before.
            let dt = now_us.wrapping_sub(last_us) as f32 * 1e-6;
            last_us = now_us;
            model.act(dt, server.task().output());
            let counts = encoders.advance(dt, &model);
            server.tick(now_us, &Sensed::of_counts(counts));
        };
        let mut uart = Uart::polled();
        with_ticks(PERIOD_US, &mut tick, || {
            while serve(&mut uart, &mut receiver) {}
        });
        semihosting::exit(EXIT_LINK);
    }

    /// What has arrived and what is to be sent; `false` when the line fails.
    fn serve(uart: &mut Uart, receiver: &mut CommandReceiver<'_>) -> bool {
        let answer = uart
            .try_read()
            .and_then(|byte| receiver.push(byte, high_water_mark));
        answer.is_none_or(|answer| send(uart, &answer))
            && receiver.pending().is_none_or(|answer| send(uart, &answer))
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board; build it with");
    println!("  cargo build -p firmware-demo --release --target thumbv7em-none-eabihf --bin robot");
    println!("and run it with");
    println!(
        "  qemu-system-arm -M mps2-an386 -display none -monitor none -serial unix:PATH,server=on \\"
    );
    println!("    -semihosting-config enable=on,target=native -kernel IMAGE");
}
