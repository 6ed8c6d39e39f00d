//! `constants`.

use super::error::CommandError;
use super::robot::load;
use super::write::Writer;
use super::{say, tell};
use crate::cli::Output;
use crate::robot_args::ConstantsArgs;
use sim_host::closed_loop::assumed;
use sim_host::constants::{c_header, module_name, rust};
use sim_host::mission::Drivers;

pub fn write(arguments: &ConstantsArgs, output: &Output) -> Result<(), CommandError> {
    let robot = load(&arguments.robot)?;
    if let Some(assumed) = assumed(&robot.base) {
        tell(&format!("warning: {}: {assumed}\n", robot.base.name));
    }
    let speeds = robot.base.hardware.as_ref();
    if speeds.is_some_and(|hardware| matches!(hardware.drivers, Drivers::SpeedLoops(..)))
        && !arguments.c
    {
        tell(&format!(
            "note: {}: no board of boards/ takes a robot with [speed_driver]: they have PWM outputs for motors only\n",
            robot.base.name
        ));
    }
    let (text, extension) = if arguments.c {
        (c_header(&robot.file, &robot.name, &robot.base), "h")
    } else {
        (rust(&robot.file, &robot.base), "rs")
    };
    let text = text.map_err(|cause| CommandError::Constants {
        file: robot.file.clone(),
        cause,
    })?;
    let name = format!("{}.{extension}", module_name(&robot.name));
    Writer::new(output)?.bytes(&name, text.as_bytes())?;
    say(&format!("{}\n", output.out.join(name).display()))
}
