//! The library, on the host.

#[path = "support/commands.rs"]
mod commands;
#[path = "support/outputs.rs"]
mod outputs;
#[path = "support/questions.rs"]
mod questions;
#[path = "support/reaches.rs"]
mod reaches;
#[path = "support/rig.rs"]
mod rig;
#[path = "support/wire.rs"]
mod wire;

mod control;
mod control_drive;
mod control_host;
mod control_server;
mod faults;
mod faults_electric;
mod hal_contract;
mod motor_pair;
mod protocol;
mod stops;
mod storage;
