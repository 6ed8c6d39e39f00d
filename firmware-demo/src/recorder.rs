//! A bench recording on its way to the line: a numbered row of every tick in which the base drives for it.

use controller_core::base::Sensed;
use controller_core::hal::WheelCounts;
use controller_core::localiser::Fix;
use protocol::pil::WheelOutput;
use protocol::{RecordedPose, RecordedRow, RecordedRows, Recording, RecordingEnd, Telemetry};

/// What a tick was.
pub struct Tick<'a> {
    /// The base drives for a recording; else why it does not any more.
    pub excites: Result<(), RecordingEnd>,
    /// The clock \[µs\].
    pub now_us: u32,
    /// Measured before the output.
    pub sensed: &'a Sensed<f32>,
    /// An external pose.
    pub fix: Option<&'a Fix<f32>>,
    /// What the drivers put out until the next tick.
    pub output: WheelOutput,
    /// Largest torque of the drivers \[N m\].
    pub max_torque_nm: f32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Phase {
    #[default]
    Off,
    On,
    /// What is left is to be sent, then the end.
    Ending(RecordingEnd),
}

/// Gathers rows to frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Recorder {
    phase: Phase,
    rows: RecordedRows,
    /// Of the next row.
    number: u32,
    /// Clock and counts of the row before.
    before: Option<(u32, WheelCounts)>,
}

impl Recorder {
    /// Whether rows are under way: reports of ticks leave them the line.
    pub fn is_on(&self) -> bool {
        self.phase != Phase::Off
    }

    /// Takes a tick. `send` says whether there was room for a message; inside why the recording cannot go on.
    ///
    /// # Errors
    /// The base is to stop; the end is sent with the next tick.
    pub fn tick(
        &mut self,
        tick: &Tick<'_>,
        mut send: impl FnMut(Telemetry) -> bool,
    ) -> Result<(), RecordingEnd> {
        if self.phase == Phase::Off && tick.excites.is_ok() {
            let full_torque_nm = match tick.output {
                WheelOutput::Torque { .. } => Some(tick.max_torque_nm),
                _ => None,
            };
            let began = Recording::Began { full_torque_nm };
            // Where there is no room yet the recording begins a tick later.
            if send(Telemetry::Recording(began)) {
                *self = Self {
                    phase: Phase::On,
                    ..Self::default()
                };
            }
        }
        if self.phase == Phase::On {
            match tick.excites {
                Ok(()) => return self.add(tick, send),
                Err(end) => self.phase = Phase::Ending(end),
            }
        }
        if let Phase::Ending(end) = self.phase {
            // Where there is no room the next tick tries again.
            if self.rows.count > 0 && send(Telemetry::Rows(self.rows)) {
                self.rows.count = 0;
            }
            let rows = self.number;
            let ended = Recording::Ended { rows, end };
            if self.rows.count == 0 && send(Telemetry::Recording(ended)) {
                self.phase = Phase::Off;
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        tick: &Tick<'_>,
        mut send: impl FnMut(Telemetry) -> bool,
    ) -> Result<(), RecordingEnd> {
        let row = self.row(tick)?;
        // What found no room when it was full has another chance, this row none beside it.
        self.pass_on(&mut send);
        let place = usize::from(self.rows.count);
        let free = self.rows.rows.get_mut(place);
        *free.ok_or(RecordingEnd::Overflow)? = row;
        self.rows.count += 1;
        if let Some(Fix { pose, age_s }) = tick.fix {
            let pose = RecordedPose {
                row: self.number,
                pose: pose.into(),
                age_s: *age_s,
            };
            if !send(Telemetry::RecordedPose(pose)) {
                return Err(RecordingEnd::Overflow);
            }
        }
        self.number = self.number.wrapping_add(1);
        self.pass_on(&mut send);
        Ok(())
    }

    /// Sends a full frame, if there is room.
    fn pass_on(&mut self, send: &mut impl FnMut(Telemetry) -> bool) {
        let full = usize::from(self.rows.count) == self.rows.rows.len();
        if full && send(Telemetry::Rows(self.rows)) {
            self.rows.count = 0;
            self.rows.first = self.number;
        }
    }

    fn row(&mut self, tick: &Tick<'_>) -> Result<RecordedRow, RecordingEnd> {
        let Sensed {
            counts,
            supply_v,
            currents,
            ..
        } = tick.sensed;
        let counts = counts.map_err(|_| RecordingEnd::Unread)?;
        let (us_before, before) = self.before.replace((tick.now_us, counts)).unwrap_or((
            // Of the first row nothing is before.
            tick.now_us,
            counts,
        ));
        let moved = |now: i32, before: i32| {
            i16::try_from(now.wrapping_sub(before)).map_err(|_| RecordingEnd::Unread)
        };
        let command = match tick.output {
            WheelOutput::Duty { right, left } => [right, left],
            WheelOutput::Torque { right, left } => {
                [right, left].map(|torque| torque / tick.max_torque_nm)
            }
            // A driver failed in this tick: what acts is not what was asked. Where speeds are commanded no drive for a recording begins.
            WheelOutput::Speed { .. } | WheelOutput::Release | WheelOutput::Brake => {
                return Err(RecordingEnd::Stopped);
            }
        };
        let current = currents.map(|currents| [currents.right, currents.left]);
        Ok(RecordedRow {
            // A tick of 65 ms and more is a fault that ends the drive.
            dt_us: u16::try_from(tick.now_us.wrapping_sub(us_before)).unwrap_or(u16::MAX),
            counts: [
                moved(counts.right, before.right)?,
                moved(counts.left, before.left)?,
            ],
            command: command.map(RecordedRow::command_of),
            current: current.map_or([RecordedRow::NONE; 2], |pair| {
                pair.map(RecordedRow::current_of)
            }),
            supply: supply_v.map_or(0, RecordedRow::supply_of),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::types::Pose;
    use protocol::ROWS;

    const DUTY: WheelOutput = WheelOutput::Duty {
        right: 0.5,
        left: -0.5,
    };

    fn sensed(right: i32) -> Sensed<f32> {
        Sensed {
            supply_v: Some(12.0),
            ..Sensed::of_counts(WheelCounts {
                right,
                left: -right,
            })
        }
    }

    fn tick(number: u32, sensed: &Sensed<f32>) -> Tick<'_> {
        Tick {
            excites: Ok(()),
            now_us: number.wrapping_mul(5000),
            sensed,
            fix: None,
            output: DUTY,
            max_torque_nm: 2.0,
        }
    }

    /// Messages, as long as there is room for so many.
    fn into<'a>(
        sent: &'a mut heapless::Vec<Telemetry, 32>,
        room: usize,
    ) -> impl FnMut(Telemetry) -> bool + 'a {
        move |message| sent.len() < room && sent.push(message).is_ok()
    }

    #[test]
    fn every_tick_is_a_row_and_the_end_says_how_many() {
        let mut recorder = Recorder::default();
        let mut sent = heapless::Vec::<Telemetry, 32>::new();
        let counts: [Sensed<f32>; 20] = core::array::from_fn(|n| sensed(100 + 7 * n as i32));
        for (number, sensed) in (0..).zip(&counts) {
            let fix = Fix {
                pose: Pose::new(1.0, 2.0, 3.0),
                age_s: 0.02,
            };
            let tick = Tick {
                fix: (number == 13).then_some(&fix),
                ..tick(number, sensed)
            };
            assert_eq!(recorder.tick(&tick, into(&mut sent, 32)), Ok(()));
        }
        let over = Tick {
            excites: Err(RecordingEnd::Complete),
            ..tick(20, &counts[19])
        };
        assert_eq!(recorder.tick(&over, into(&mut sent, 32)), Ok(()));
        assert!(!recorder.is_on());
        let mut rows = heapless::Vec::<RecordedRow, 32>::new();
        for message in &sent {
            if let Telemetry::Rows(frame) = message {
                assert_eq!(frame.first as usize, rows.len());
                rows.extend(frame.rows[..usize::from(frame.count)].iter().copied());
            }
        }
        assert_eq!(rows.len(), 20);
        assert_eq!((rows[0].dt_us, rows[0].counts), (0, [0, 0]));
        for row in &rows[1..] {
            assert_eq!((row.dt_us, row.counts), (5000, [7, -7]));
            assert_eq!((row.current, row.supply), ([RecordedRow::NONE; 2], 12_000));
            assert_eq!(row.command, [16_384, -16_384]);
        }
        assert_eq!(
            sent[0],
            Telemetry::Recording(Recording::Began {
                full_torque_nm: None
            })
        );
        let ended = Recording::Ended {
            rows: 20,
            end: RecordingEnd::Complete,
        };
        assert_eq!(sent.last(), Some(&Telemetry::Recording(ended)));
        let poses = sent.iter().filter_map(|message| match message {
            Telemetry::RecordedPose(pose) => Some(pose.row),
            _ => None,
        });
        assert!(poses.eq([13]));
    }

    #[test]
    fn a_row_that_finds_no_room_ends_the_drive_and_the_end_comes_when_there_is_room() {
        let mut recorder = Recorder::default();
        let mut sent = heapless::Vec::<Telemetry, 32>::new();
        let here = sensed(0);
        let mut failed = None;
        for number in 0..100 {
            // Room for the begin and one frame.
            if let Err(end) = recorder.tick(&tick(number, &here), into(&mut sent, 2)) {
                failed = Some((number, end));
                break;
            }
        }
        assert_eq!(failed, Some((2 * ROWS as u32, RecordingEnd::Overflow)));
        let over = |number| Tick {
            excites: Err(RecordingEnd::Overflow),
            ..tick(number, &here)
        };
        assert_eq!(recorder.tick(&over(100), into(&mut sent, 2)), Ok(()));
        assert!(recorder.is_on());
        assert_eq!(recorder.tick(&over(101), into(&mut sent, 32)), Ok(()));
        assert!(!recorder.is_on());
        let ended = Recording::Ended {
            rows: 2 * ROWS as u32,
            end: RecordingEnd::Overflow,
        };
        assert_eq!(sent.last(), Some(&Telemetry::Recording(ended)));
    }

    #[test]
    fn torques_are_shares_and_what_does_not_fit_a_row_ends_the_drive() {
        let mut recorder = Recorder::default();
        let here = sensed(0);
        let torque = Tick {
            output: WheelOutput::Torque {
                right: 1.0,
                left: -2.0,
            },
            ..tick(0, &here)
        };
        let mut began = None;
        let first = recorder.tick(&torque, |message| {
            began.get_or_insert(message);
            true
        });
        assert_eq!(first, Ok(()));
        let full_torque_nm = Some(2.0);
        assert_eq!(
            began,
            Some(Telemetry::Recording(Recording::Began { full_torque_nm }))
        );
        assert_eq!(recorder.rows.rows[0].command, [16_384, -RecordedRow::FULL]);
        let far = sensed(40_000);
        let jumped = recorder.tick(&tick(1, &far), |_| true);
        assert_eq!(jumped, Err(RecordingEnd::Unread));
        let unread = Sensed {
            counts: Err(controller_core::hal::ErrorKind::Bus),
            ..here
        };
        let blind = recorder.tick(&tick(2, &unread), |_| true);
        assert_eq!(blind, Err(RecordingEnd::Unread));
        let released = Tick {
            output: WheelOutput::Release,
            ..tick(3, &far)
        };
        assert_eq!(
            recorder.tick(&released, |_| true),
            Err(RecordingEnd::Stopped)
        );
    }
}
