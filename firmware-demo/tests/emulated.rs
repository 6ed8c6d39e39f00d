//! The images in the emulator: both links on both machines, the counter, and the proof that nothing panics.

use std::time::Duration;

use crate::support::{LIMIT, MACHINES, image, options};
use firmware_demo::host::{
    Emulator, EmulatorError, Image, LinkKind, Machine, Options, Session, SessionError, build_image,
};
use protocol::Command;
use protocol::pil::{Answer, Question};

#[test]
fn commands_for_a_robot_are_no_questions() {
    for machine in MACHINES {
        let options = options(machine, LinkKind::Fifo, false);
        let (emulator, link) = Emulator::start(&image(machine, "pil"), &options).unwrap();
        let mut session = Session::new(link.unwrap());
        let hello = session.ask(&Question::Hello).unwrap();
        assert!(matches!(hello, Answer::Hello(_)));
        // They are counted, and nobody answers.
        for command in [Command::Arm, Command::ResetFault] {
            session.send(&command).unwrap();
        }
        let Ok(Answer::Counters(counters)) = session.ask(&Question::GetCounters) else {
            panic!("no counters")
        };
        assert_eq!((counters.frames_good, counters.frames_rejected), (2, 2));
        assert_eq!(session.ask(&Question::Stop).unwrap(), Answer::Ack);
        assert_eq!(emulator.finish(LIMIT).unwrap().code, Some(0));
    }
}

#[test]
fn firmware_survives_rubbish_on_the_serial_port() {
    use std::io::Write;

    let machine = Machine::CortexM4F;
    let options = options(machine, LinkKind::Uart, false);
    let (emulator, link) = Emulator::start(&image(machine, "pil"), &options).unwrap();
    let mut link = link.unwrap();
    link.write_all(b"\x05rubbish that is no frame at all\x00more\x00and some unfinished")
        .unwrap();
    link.write_all(&[0]).unwrap();
    let mut session = Session::new(link);
    assert!(matches!(
        session.ask(&Question::Hello),
        Ok(Answer::Hello(_))
    ));
    let Ok(Answer::Counters(counters)) = session.ask(&Question::GetCounters) else {
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
            let mut lines = outcome.console.lines();
            assert!(
                lines.any(|line| line == "thousand-nops 1000 1000.00 1000"),
                "{outcome:?}"
            );
        }
    }
}

#[test]
fn images_have_no_allocator() {
    for machine in MACHINES {
        for bin in ["pil", "cost", "robot", "base", "board_pil"] {
            let bytes = std::fs::read(image(machine, bin)).unwrap();
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
    let image = image(machine, "pil");
    let silence = Duration::from_millis(300);
    let options = Options {
        silence,
        ..options(machine, LinkKind::Fifo, false)
    };
    let (emulator, link) = Emulator::start(&image, &options).unwrap();
    let mut session = Session::new(link.unwrap());
    assert!(matches!(
        session.ask(&Question::Hello),
        Ok(Answer::Hello(_))
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
            Session::<_, Answer>::new(link.unwrap())
                .ask(&Question::Hello)
                .map_err(|error| error.to_string())
        });
        assert!(!matches!(answer, Ok(Ok(_))), "{answer:?}");
    }
}
