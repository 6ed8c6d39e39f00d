//! A drive of a live base for its identification, over its line.

use firmware_demo::control_server::Queues;
use rayon::prelude::*;
use sim_host::identify::live::{Bench, BenchError, record_live};
use sim_host::identify::record::sensed_world;
use sim_host::identify::{Log, Options, Quantity, Verdict, identify};
use sim_host::mission::BaseSpec;
use sim_host::monitor::RecordedDrive;
use sim_host::teleop::Simulated;
use sim_host::world::WorldSetup;
use std::path::Path;

fn base(name: &str) -> BaseSpec {
    let bases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bases");
    BaseSpec::load(&bases.join(name).with_extension("toml")).expect("a base")
}

const BENCH: Bench = Bench {
    space_m: [2.0, 1.0],
    speed: None,
    turn_rate: None,
    duration_s: 30.0,
    seed: 1,
    baud: None,
};

#[test]
fn experiment() {
    for name in ["hobby-1kg", "lab-10kg", "paper-30kg"] {
        let base = base(name);
        let hardware = base.hardware.expect("motors");
        let started = std::time::Instant::now();
        let found: Vec<_> = (0..6_u32)
            .into_par_iter()
            .map(|seed| {
                let setup = WorldSetup {
                    world: sensed_world(&hardware),
                    seed: u64::from(seed),
                };
                let mut queues = Queues::default();
                let mut line = Simulated::new(&mut queues, &base, &setup, false).expect("a base");
                let bench = Bench {
                    seed,
                    space_m: if name == "paper-30kg" { [4.0, 2.0] } else { [2.0, 1.0] },
                    ..BENCH
                };
                let mut asked = None;
                let drive = record_live(&mut line, &bench, |p| asked = Some(*p.order));
                let drive = drive.expect("a recording");
                let mut csv = Vec::new();
                drive.write(&mut csv).expect("written");
                if seed == 0 {
                    std::fs::write(format!("/tmp/rec-{name}.csv"), &csv).unwrap();
                    println!("{asked:?}");
                }
                let log = Log::read(&csv[..], Some(hardware.counts_per_turn)).expect("a log");
                let mut options = Options::default();
                options.known.gear = Some(hardware.motor.gear_ratio);
                options.known.current_limit_a = Some(hardware.motor.current_limit_a);
                let found = identify(&log, &options).expect("signs agree");
                if seed == 0 {
                    println!("{}", sim_host::identify::report::text(&found));
                }
                found
            })
            .collect();
        let truths = sim_host::identify::coverage::truths(&base, &hardware);
        for (name, truth) in truths {
            let mut line = format!("{name:24} {truth:10.5}");
            for found in &found {
                let entries = found.quantities.iter().chain(&found.combinations);
                match entries.filter(|e| e.name == name).map(|e| &e.verdict).next() {
                    Some(Verdict::Identified { value, half_width }) => {
                        line += &format!(" {:6.2}±1({:.2}%)", (value - truth) / half_width, 100.0 * half_width / truth);
                    }
                    _ => line += " -",
                }
            }
            println!("{line}");
        }
        println!("{name} {:?}", started.elapsed());
    }
}
