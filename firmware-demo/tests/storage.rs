//! Parameters in flash: whole, or the reason is reported.

use crate::commands;
use controller_core::base::Sensed;
use controller_core::hal::WheelCounts;
use controller_core::safety::supervisor::State;
use controller_core::types::Pose;
use firmware_demo::control::ControlTask;
use firmware_demo::control_server::{CommandReceiver, ControlServer, Queues, UNASKED};
use firmware_demo::drive::MockDrive;
use firmware_demo::mission;
use firmware_demo::storage::{
    Memory, NotLoaded, RECORD, RECORD_VERSION, RamFlash, Record, RecordError, SaveError, Slots,
};
use proptest::prelude::*;
use protocol::{Command, FieldParams, Frame, MAX_FRAME, Origin, RejectReason, Telemetry, encode};

const TORQUE: f32 = 15.0;

fn field(speed: f32) -> FieldParams {
    let mut field = FieldParams::from(&mission::params(TORQUE, false).unwrap());
    field.limits.speed = speed;
    field
}

/// Makes the check of changed bytes right again.
fn sealed(mut bytes: [u8; RECORD]) -> [u8; RECORD] {
    let check = protocol::CRC.checksum(&bytes[..RECORD - 4]);
    bytes[RECORD - 4..].copy_from_slice(&check.to_le_bytes());
    bytes
}

proptest! {
    /// All bit patterns of floats, all times and responses: what comes out is what went in.
    #[test]
    fn records_read_back(params in commands::field(), sequence: u32) {
        let bytes = Record { sequence, params }.to_bytes().expect("it fits");
        let again = Record::from_bytes(&bytes).expect("whole");
        // By their bytes, for a NaN is not equal to itself.
        prop_assert_eq!(again.to_bytes(), Some(bytes));
        prop_assert_eq!(again.sequence, sequence);
    }

    #[test]
    fn field_parameters_are_put_back_where_they_came_from(params in commands::field()) {
        let base = mission::params(TORQUE, true).unwrap();
        let there = params.apply(&base);
        let again = FieldParams::from(&there);
        prop_assert_eq!(format!("{again:?}"), format!("{params:?}"));
        // And nothing else is touched.
        prop_assert_eq!(FieldParams::from(&base).apply(&there), base);
    }
}

#[test]
fn every_flipped_bit_is_detected() {
    let record = Record {
        sequence: 77,
        params: field(1.25),
    };
    let bytes = record.to_bytes().unwrap();
    assert_eq!(Record::from_bytes(&bytes), Ok(record));
    for bit in 0..8 * RECORD {
        let mut flipped = bytes;
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(
            Record::from_bytes(&flipped),
            Err(RecordError::Check),
            "bit {bit}"
        );
    }
}

#[test]
fn version_from_the_future_is_refused_and_not_written_over_first() {
    let mut future = Record {
        sequence: 3,
        params: field(1.0),
    }
    .to_bytes()
    .unwrap();
    future[0] = RECORD_VERSION + 1;
    let future = sealed(future);
    let strange = RECORD_VERSION + 1;
    assert_eq!(
        Record::from_bytes(&future),
        Err(RecordError::Version(strange))
    );
    for second in [false, true] {
        let mut flash = RamFlash::default();
        let begin = if second { RECORD } else { 0 };
        flash.bytes_mut()[begin..begin + RECORD].copy_from_slice(&future);
        let mut slots = Slots::new(flash);
        assert_eq!(slots.load().record, Err(NotLoaded::Version(strange)));
        assert_eq!(slots.save(&field(1.5)), Ok(0));
        assert_eq!(slots.load().record.unwrap().params, field(1.5));
        let mut flash = slots.into_flash();
        assert_eq!(flash.bytes_mut()[begin..begin + RECORD], future);
    }
}

#[test]
fn content_that_is_none_is_refused() {
    let mut bytes = Record {
        sequence: 3,
        params: field(1.0),
    }
    .to_bytes()
    .unwrap();
    // The padding is not all zeros: something longer was written.
    bytes[RECORD - 5] = 1;
    assert_eq!(
        Record::from_bytes(&sealed(bytes)),
        Err(RecordError::Content)
    );
    assert_eq!(Record::from_bytes(&[0xFF; RECORD]), Err(RecordError::Empty));
}

/// An erase of 256 bytes, a write of 256: power fails before each of them, with an old record in either slot or in none.
#[test]
fn power_lost_at_any_byte_leaves_a_whole_record() {
    for saved in 0..4_u32 {
        let mut before = Slots::new(RamFlash::default());
        for number in 0..saved {
            before.save(&field(1.0 + number as f32)).unwrap();
        }
        let old = before.load().record;
        let new = field(9.0);
        let flash = before.into_flash();
        for bytes in 0..=2 * RECORD as u32 {
            let mut cut = flash.clone();
            cut.fail_after(bytes);
            let mut slots = Slots::new(cut);
            let outcome = slots.save(&new);
            let mut flash = slots.into_flash();
            flash.power_on();
            let mut slots = Slots::new(flash);
            let now = slots.load();
            match now.record {
                Ok(record) if record.params == new => assert_eq!(bytes, 2 * RECORD as u32),
                Ok(record) => assert_eq!(Ok(record), old, "{saved} saved, {bytes} bytes"),
                Err(why) => {
                    assert_eq!(saved, 0, "an old record was lost after {bytes} bytes");
                    assert!(matches!(why, NotLoaded::Empty | NotLoaded::Damaged));
                }
            }
            if bytes < 2 * RECORD as u32 {
                assert_eq!(outcome, Err(SaveError::Flash));
            }
            // And it can be saved again at once.
            slots.save(&new).unwrap();
            assert_eq!(slots.load().record.unwrap().params, new);
        }
    }
}

#[test]
fn wear_alternates_and_numbers_wrap_around() {
    let mut slots = Slots::new(RamFlash::default());
    for number in 0..100_u32 {
        assert_eq!(slots.save(&field(1.0)), Ok(number));
    }
    assert_eq!(slots.into_flash().erased(), [50, 50]);

    let mut flash = RamFlash::default();
    let last = Record {
        sequence: u32::MAX,
        params: field(1.0),
    };
    flash.bytes_mut()[..RECORD].copy_from_slice(&last.to_bytes().unwrap());
    let mut slots = Slots::new(flash);
    assert_eq!(slots.save(&field(2.0)), Ok(0));
    assert_eq!(slots.load().record.unwrap().params, field(2.0));
    assert_eq!(slots.save(&field(3.0)), Ok(1));
    assert_eq!(slots.load().record.unwrap().params, field(3.0));
}

/// A slot of four records: each save is an append, and only the ninth needs the room of the first four again.
#[test]
fn a_large_slot_takes_many_records_before_it_is_erased() {
    let mut slots = Slots::new(RamFlash::<1024>::blank());
    for number in 0..16_u32 {
        assert_eq!(slots.save(&field(number as f32 + 1.0)), Ok(number));
        let flash = slots.into_flash();
        slots = Slots::new(flash);
        let loaded = slots.load();
        assert_eq!(loaded.record.unwrap().params, field(number as f32 + 1.0));
        assert!(!loaded.damaged);
    }
    assert_eq!(slots.into_flash().erased(), [2, 2]);
}

/// What is erased at the start need not be erased in a tick: after it at least half a slot of records is written without.
#[test]
fn a_prepared_flash_saves_without_an_erase() {
    for saved in 0..12_u32 {
        let mut slots = Slots::new(RamFlash::<1024>::blank());
        for _ in 0..saved {
            slots.save(&field(1.0)).unwrap();
        }
        let mut slots = Slots::new(slots.into_flash());
        let old = slots.load().record;
        slots.prepare().unwrap();
        assert_eq!(slots.load().record, old, "{saved} saved");
        let erased = slots.flash_mut().erased();
        for more in 0..2 {
            assert_eq!(slots.save(&field(2.0)), Ok(saved + more));
        }
        assert_eq!(slots.flash_mut().erased(), erased, "{saved} saved");
        assert_eq!(slots.load().record.unwrap().params, field(2.0));
    }
}

/// Power fails before each byte of an append: the record before stays, is loaded, and the cut one is passed over.
#[test]
fn power_lost_in_an_append_leaves_the_last_record() {
    let mut slots = Slots::new(RamFlash::<1024>::blank());
    slots.save(&field(1.0)).unwrap();
    let flash = slots.into_flash();
    for bytes in 0..RECORD as u32 {
        let mut cut = flash.clone();
        cut.fail_after(bytes);
        let mut slots = Slots::new(cut);
        assert_eq!(slots.save(&field(2.0)), Err(SaveError::Flash));
        slots.flash_mut().power_on();
        let loaded = slots.load();
        assert_eq!(loaded.record.unwrap().params, field(1.0), "{bytes}");
        assert_eq!(loaded.damaged, bytes > 0, "{bytes}");
        assert_eq!(slots.save(&field(3.0)), Ok(1));
        assert_eq!(slots.load().record.unwrap().params, field(3.0));
        assert_eq!(slots.flash_mut().erased(), [1, 0]);
    }
}

#[test]
fn worn_out_flash_is_reported() {
    let mut slots = Slots::new(RamFlash::default());
    slots.save(&field(1.0)).unwrap();
    let mut flash = slots.into_flash();
    flash.bytes_mut()[20] ^= 4;
    let mut slots = Slots::new(flash);
    assert_eq!(slots.load().record, Err(NotLoaded::Damaged));
    slots.save(&field(2.0)).unwrap();
    let loaded = slots.load();
    assert_eq!(loaded.record.unwrap().params, field(2.0));
}

struct Robot {
    server: ControlServer<'static, MockDrive<0>, Slots<RamFlash>>,
    receiver: CommandReceiver<'static>,
    now_us: u32,
}

impl Robot {
    fn start(flash: RamFlash) -> Self {
        let queues = Box::leak(Box::new(Queues::default()));
        let (references, ends, receiver) = queues.split(1);
        let defaults = mission::params(TORQUE, false).unwrap();
        let wheels = MockDrive::new(TORQUE);
        let task = ControlTask::new(wheels, references, defaults, Pose::default()).unwrap();
        Self {
            server: ControlServer::with_memory(task, ends, Slots::new(flash)),
            receiver,
            now_us: 0,
        }
    }

    /// The answer, and what came unasked.
    fn ask(&mut self, command: &Command) -> (Telemetry, Vec<Telemetry>) {
        let mut frame = [0; MAX_FRAME];
        for &byte in encode(5, command, &mut frame).unwrap() {
            assert_eq!(self.receiver.push(byte, || 0), None);
        }
        self.now_us += 1000;
        let sensed = Sensed::of_counts(WheelCounts::default());
        self.server.tick(self.now_us, &sensed);
        let (mut answer, mut unasked) = (None, Vec::new());
        while let Some(Frame { sequence, message }) = self.receiver.pending() {
            if sequence == UNASKED {
                unasked.push(message);
            } else {
                answer = Some(message);
            }
        }
        (answer.unwrap(), unasked)
    }

    fn speed(&self) -> f32 {
        self.server.task().params().motion.limits.speed
    }
}

#[test]
fn what_is_saved_is_in_force_after_the_next_power_on() {
    let mut robot = Robot::start(RamFlash::default());
    let (_, unasked) = robot.ask(&Command::GetParameters);
    let empty = Telemetry::Origin(Origin::Defaults(NotLoaded::Empty));
    assert!(unasked.contains(&empty), "{unasked:?}");
    let set = Command::SetParameters(field(1.25));
    let (answer, unasked) = robot.ask(&set);
    assert_eq!(answer, Telemetry::Ack);
    assert!(unasked.contains(&Telemetry::Origin(Origin::Host)));
    assert_eq!(robot.ask(&Command::SaveParameters).0, Telemetry::Ack);
    assert_eq!(robot.server.origin(), Origin::Stored { sequence: 0 });

    // Armed, nothing of all that.
    assert_eq!(robot.ask(&Command::Arm).0, Telemetry::Ack);
    for command in [set, Command::SaveParameters, Command::LoadDefaults] {
        let refused = Telemetry::Nack(RejectReason::State);
        let (answer, unasked) = robot.ask(&command);
        assert_eq!(answer, refused);
        // With the state that it is refused for, whether or not its change was heard of.
        let told = |message: &Telemetry| {
            matches!(
                message,
                Telemetry::State {
                    state: State::Armed,
                    ..
                }
            )
        };
        assert!(unasked.iter().any(told), "{unasked:?}");
    }

    // The same flash under a robot that has just been switched on.
    let mut slots = Slots::new(RamFlash::default());
    slots.save(&field(1.25)).unwrap();
    let mut robot = Robot::start(slots.into_flash());
    assert_eq!(robot.speed(), 1.25);
    assert_eq!(robot.ask(&Command::LoadDefaults).0, Telemetry::Ack);
    assert_eq!(robot.speed(), 2.5);
    let asked = Origin::Defaults(NotLoaded::Asked);
    assert_eq!(robot.server.origin(), asked);
}

#[test]
fn what_is_stored_and_out_of_range_leaves_the_defaults() {
    for (flash, why) in [
        (stored(&field(-1.0)), NotLoaded::Refused),
        (
            {
                let mut flash = stored(&field(1.0));
                flash.bytes_mut()[9] ^= 1;
                flash
            },
            NotLoaded::Damaged,
        ),
    ] {
        let mut robot = Robot::start(flash);
        assert_eq!(robot.speed(), 2.5);
        let (_, unasked) = robot.ask(&Command::GetParameters);
        let applied = Telemetry::Origin(Origin::Defaults(why));
        assert!(unasked.contains(&applied), "{unasked:?}");
    }
}

fn stored(params: &FieldParams) -> RamFlash {
    let mut slots = Slots::new(RamFlash::default());
    slots.save(params).unwrap();
    slots.into_flash()
}
