//! Logs of runs, written beside them.

use super::{DataLog, DataLogError, Sample};
use crate::csv_out::{Columns, Line};
use crate::run::{Seen, Watch, WheelStates};
use crate::trace::TraceRow;
use controller_core::types::Measured;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

/// Rows that are handed over at once, and how many such batches may wait: then the run does.
const BATCH: (usize, usize) = (128, 512);

/// What there is to a tick.
struct Row {
    tick: usize,
    row: TraceRow,
    handed_over: bool,
    measured: Measured<f64>,
    wheels: Option<WheelStates>,
}

/// What is still being written of a run.
#[must_use = "a log is whole when it is finished"]
pub struct Pending(JoinHandle<Result<(), DataLogError>>);

impl Pending {
    /// Waits until all is written.
    ///
    /// # Errors
    /// Those of the file.
    pub fn finish(self) -> Result<(), DataLogError> {
        match self.0.join() {
            Ok(written) => written,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

/// Runs something that is watched, and writes what is seen to `log` on a thread of its own: neither the run nor what follows it
/// waits for encoding and compression, which take longer than the ticks of an ideal plant.
pub fn logged<T>(log: DataLog, columns: Columns, run: impl FnOnce(Watch<'_>) -> T) -> (T, Pending) {
    let (sender, receiver) = sync_channel(BATCH.1);
    let writer = std::thread::spawn(move || write(log, columns, &receiver));
    let mut batch = Batch {
        rows: Vec::with_capacity(BATCH.0),
        sender,
    };
    let done = run(Some(&mut |seen| batch.push(seen)));
    batch.send();
    (done, Pending(writer))
}

struct Batch {
    rows: Vec<Row>,
    sender: SyncSender<Vec<Row>>,
}

impl Batch {
    fn push(&mut self, seen: &Seen<'_>) {
        self.rows.push(Row {
            tick: seen.line.tick,
            row: *seen.line.row,
            handed_over: seen.line.handed_over,
            measured: seen.measured,
            wheels: seen.wheels,
        });
        if self.rows.len() == BATCH.0 {
            self.send();
        }
    }

    fn send(&mut self) {
        let rows = std::mem::replace(&mut self.rows, Vec::with_capacity(BATCH.0));
        // A writer that has failed says so in the end.
        let _ = self.sender.send(rows);
    }
}

fn write(
    mut log: DataLog,
    columns: Columns,
    receiver: &Receiver<Vec<Row>>,
) -> Result<(), DataLogError> {
    for rows in receiver {
        let lines = rows.iter().map(|row| Line {
            tick: row.tick,
            row: &row.row,
            handed_over: row.handed_over,
        });
        for ((line, fields), row) in columns.fields(lines).zip(&rows) {
            let seen = Seen {
                line,
                measured: row.measured,
                wheels: row.wheels,
            };
            log.add(&Sample::from(&seen), &fields)?;
        }
    }
    log.finish()
}
