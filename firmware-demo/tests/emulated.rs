//! The images in the emulator: both links on both machines, the counter, and the proof that nothing panics.

use std::time::Duration;

use firmware_demo::host::{
    AnyLink, Emulator, EmulatorError, Image, LinkKind, Machine, Options, Session, SessionError,
    build_image,
};
use firmware_demo::pil::stand_in;
use firmware_demo::protocol::{
    Command, Measure, RejectReason, Report, Telemetry, WirePose, WireTwist,
};

const MACHINES: [Machine; 2] = [Machine::CortexM4F, Machine::Riscv32];
const LIMIT: Duration = Duration::from_secs(20);

fn options(machine: Machine, link: LinkKind, icount: bool) -> Options {
    Options {
        machine,
        link,
        icount,
        core: None,
        silence: LIMIT,
    }
}

/// Builds with the panic proof: that it links is half of each test.
fn start(machine: Machine, link: LinkKind, icount: bool) -> (Emulator, Session<AnyLink>) {
    let image = build_image(&Image {
        machine,
        bin: "pil",
        features: "panic-proof",
    })
    .unwrap();
    let (emulator, link) = Emulator::start(&image, &options(machine, link, icount)).unwrap();
    (emulator, Session::new(link.unwrap()))
}

fn measure(tick: u32) -> Measure {
    let x = tick as f32 * 0.37 - 3.0;
    let pose = WirePose {
        x,
        y: f32::from_bits(tick.wrapping_mul(0x9E37_79B9)),
        theta: -x,
    };
    Measure {
        tick,
        dt: 1e-3,
        pose,
        twist: WireTwist {
            v: x * x,
            w: 1.0 / x,
        },
    }
}

/// Bits of a report but for the instructions, which the host cannot know.
fn bits(report: &Report) -> Vec<u8> {
    let mut bytes = [0; 256];
    let report = Report {
        instructions: 0,
        ..*report
    };
    postcard::to_slice(&report, &mut bytes).unwrap().to_vec()
}

fn exchange(machine: Machine, link: LinkKind, ticks: u32) {
    let (emulator, mut session) = start(machine, link, true);
    assert!(matches!(
        session.ask(&Command::Heartbeat),
        Ok(Telemetry::Hello(_))
    ));
    let nack = session.ask(&Command::Arm).unwrap();
    assert_eq!(nack, Telemetry::Nack(RejectReason::Unsupported));
    for tick in 0..ticks {
        let question = measure(tick);
        let answer = session.ask(&Command::Measure(question)).unwrap();
        let Telemetry::Report(report) = answer else {
            panic!("{answer:?}")
        };
        let mut expected = Report::default();
        stand_in(&question, &mut expected);
        assert_eq!(bits(&report), bits(&expected), "tick {tick}");
        // Some, and the same in every tick: the stand-in has no branch.
        assert!(
            (10..100).contains(&report.instructions),
            "{}",
            report.instructions
        );
    }
    let Ok(Telemetry::Counters(counters)) = session.ask(&Command::GetCounters) else {
        panic!("no counters")
    };
    assert_eq!(
        (counters.frames_good, counters.frames_rejected),
        (ticks + 3, 0)
    );
    assert!((256..4096).contains(&counters.stack_bytes), "{counters:?}");
    assert_eq!(session.ask(&Command::Stop).unwrap(), Telemetry::Ack);
    assert_eq!(emulator.finish(LIMIT).unwrap().code, Some(0));
}

#[test]
fn fifos_carry_every_bit() {
    for machine in MACHINES {
        exchange(machine, LinkKind::Fifo, 5000);
    }
}

#[test]
fn serial_port_carries_every_bit() {
    for machine in MACHINES {
        exchange(machine, LinkKind::Uart, 200);
    }
}

#[test]
fn firmware_survives_rubbish_on_the_serial_port() {
    use std::io::Write;

    let machine = Machine::CortexM4F;
    let image = build_image(&Image {
        machine,
        bin: "pil",
        features: "panic-proof",
    })
    .unwrap();
    let options = options(machine, LinkKind::Uart, false);
    let (emulator, link) = Emulator::start(&image, &options).unwrap();
    let mut link = link.unwrap();
    link.write_all(b"\x05rubbish that is no frame at all\x00more\x00and some unfinished")
        .unwrap();
    link.write_all(&[0]).unwrap();
    let mut session = Session::new(link);
    assert!(matches!(
        session.ask(&Command::Heartbeat),
        Ok(Telemetry::Hello(_))
    ));
    let Ok(Telemetry::Counters(counters)) = session.ask(&Command::GetCounters) else {
        panic!("no counters")
    };
    assert_eq!((counters.frames_good, counters.frames_rejected), (2, 3));
    drop(emulator);
}

#[test]
fn counter_counts_instructions() {
    for machine in MACHINES {
        for features in ["panic-proof", ""] {
            let image = build_image(&Image {
                machine,
                bin: "cost",
                features,
            })
            .unwrap();
            let options = options(machine, LinkKind::None, true);
            let (emulator, _) = Emulator::start(&image, &options).unwrap();
            let outcome = emulator.finish(LIMIT).unwrap();
            assert_eq!(outcome.code, Some(0), "{outcome:?}");
            let first = outcome.console.lines().next();
            assert_eq!(
                first,
                Some("thousand-nops 1000 1000.00 1000"),
                "{outcome:?}"
            );
        }
    }
}

#[test]
fn images_have_no_allocator() {
    for machine in MACHINES {
        for bin in ["pil", "cost"] {
            let image = build_image(&Image {
                machine,
                bin,
                features: "panic-proof",
            })
            .unwrap();
            let bytes = std::fs::read(image).unwrap();
            for symbol in [
                &b"__rust_alloc"[..],
                b"__rust_no_alloc_shim",
                b"a_panic_is_reachable",
            ] {
                let found = bytes.windows(symbol.len()).any(|window| window == symbol);
                // The name of the undefined symbol stays in the debug information only if it was linked.
                assert!(!found, "{bin}: {}", String::from_utf8_lossy(symbol));
            }
        }
    }
}

#[test]
fn a_hung_firmware_is_given_up_and_killed() {
    let machine = Machine::CortexM4F;
    let image = build_image(&Image {
        machine,
        bin: "pil",
        features: "",
    })
    .unwrap();
    let silence = Duration::from_millis(300);
    let options = Options {
        silence,
        ..options(machine, LinkKind::Fifo, false)
    };
    let (emulator, link) = Emulator::start(&image, &options).unwrap();
    let mut session = Session::new(link.unwrap());
    assert!(matches!(
        session.ask(&Command::Heartbeat),
        Ok(Telemetry::Hello(_))
    ));
    // Nothing was asked, so nothing comes.
    assert!(matches!(session.receive(), Err(SessionError::Link(_))));
    assert!(matches!(
        emulator.finish(silence),
        Err(EmulatorError::Timeout(_))
    ));
}

#[test]
fn a_missing_image_is_an_error_not_a_hang() {
    let machine = Machine::CortexM4F;
    let silence = Duration::from_millis(500);
    let path = std::env::temp_dir().join("no-such-image");
    for link in [LinkKind::Fifo, LinkKind::Uart] {
        let options = Options {
            silence,
            ..options(machine, link, false)
        };
        let answer = Emulator::start(&path, &options).map(|(_emulator, link)| {
            Session::new(link.unwrap())
                .ask(&Command::Heartbeat)
                .map_err(|error| error.to_string())
        });
        assert!(!matches!(answer, Ok(Ok(_))), "{answer:?}");
    }
}
