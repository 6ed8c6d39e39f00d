//! Theorem 7: what was stored is there, whatever is done and wherever the power fails.

use firmware_demo::mission;
use firmware_demo::storage::{Memory, NotLoaded, RECORD, RamFlash, Slots};
use protocol::FieldParams;

/// Calls in a sequence.
const DEPTH: u32 = 5;

/// What can be done. Numbers are the bytes after which the power fails.
#[derive(Clone, Copy, Debug)]
enum Call {
    Save(Option<u32>),
    Prepare(Option<u32>),
    /// Power off and on.
    Restart,
}

fn calls() -> Vec<Call> {
    let record = RECORD as u32;
    // In the erase and in the write, at their first, an inner and their last byte.
    let cuts = [0, 1, 100, record - 1, record, record + 100, 2 * record];
    let mut calls = vec![Call::Save(None), Call::Prepare(None), Call::Restart];
    calls.extend(cuts.map(|cut| Call::Save(Some(cut))));
    calls.extend([1, 100].map(|cut| Call::Prepare(Some(cut))));
    calls
}

/// Parameters that are known by their speed.
fn params(number: u32) -> FieldParams {
    let mut params = FieldParams::from(&mission::params(15.0, false).expect("valid"));
    params.limits.speed = number as f32;
    params
}

/// What is stored, by number; 0 is nothing.
struct Walk<const UNIT: usize> {
    calls: Vec<Call>,
    visited: u64,
    cut: u64,
}

impl<const UNIT: usize> Walk<UNIT> {
    fn go(&mut self, slots: &Slots<RamFlash<UNIT>>, stored: u32, next: u32, depth: u32) {
        for call in self.calls.clone() {
            let mut slots = slots.clone();
            let mut may_be = stored;
            match call {
                Call::Restart => slots = Slots::new(slots.into_flash()),
                Call::Save(cut) | Call::Prepare(cut) => {
                    if let Some(bytes) = cut {
                        slots.flash_mut().fail_after(bytes);
                    }
                    let saved = match call {
                        Call::Save(_) => slots.save(&params(next)).map(|_| next),
                        _ => slots.prepare().map(|()| stored),
                    };
                    slots.flash_mut().power_on();
                    match saved {
                        Ok(number) => may_be = number,
                        // A record may be whole although nobody was notified.
                        Err(_) => self.cut += 1,
                    }
                }
            }
            self.visited += 1;
            let acknowledged = may_be;
            let found = match slots.load().record {
                Ok(record) => record.params.limits.speed as u32,
                Err(NotLoaded::Empty | NotLoaded::Damaged) => 0,
                Err(why) => panic!("{call:?}: {why:?}"),
            };
            let whole =
                acknowledged == stored && found == next && matches!(call, Call::Save(Some(_)));
            assert!(
                found == acknowledged || whole,
                "{call:?}: {found} for {acknowledged}"
            );
            if depth > 1 {
                self.go(&slots, found, next + 1, depth - 1);
            }
        }
    }
}

fn every_sequence<const UNIT: usize>() {
    let mut walk = Walk::<UNIT> {
        calls: calls(),
        visited: 0,
        cut: 0,
    };
    walk.go(&Slots::new(RamFlash::<UNIT>::blank()), 0, 1, DEPTH);
    println!(
        "{} calls, {} of them cut off, slots of {UNIT}",
        walk.visited, walk.cut
    );
    assert!(walk.cut > 1_000);
}

/// Slots of one record and of two.
#[test]
fn what_was_stored_is_there_after_every_sequence_of_calls_and_cuts() {
    every_sequence::<RECORD>();
    every_sequence::<{ 2 * RECORD }>();
}
