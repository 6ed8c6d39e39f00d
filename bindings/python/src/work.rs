//! Long work: without the GIL, on every core, with progress and Ctrl-C.

use crate::error;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How often Python is asked for Ctrl-C and informed of progress.
const LOOK: Duration = Duration::from_millis(50);

/// What the parts of a work tell.
#[derive(Default)]
pub struct Progress {
    done: AtomicU64,
    stop: AtomicBool,
}

/// What a work that is to stop unwinds with.
struct Stopped;

impl Progress {
    /// Does a part, unless the work is to stop: then it does not return.
    pub fn part<T>(&self, part: impl FnOnce() -> T) -> T {
        self.obey();
        let answer = part();
        self.done.fetch_add(1, Ordering::Relaxed);
        answer
    }

    /// A part begins. Does not return if the work is to stop.
    pub fn begin(&self) {
        self.obey();
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Unwinds if the work is to stop. It is no panic: no hook is called and nothing is printed. Rayon goes on with what
    /// it has already handed out, so this has to come before the work of each part, and where one takes long, during it.
    pub fn obey(&self) {
        if self.stop.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }
}

/// Does a work of `total` parts on `threads` threads, or as many as there are cores. `progress` is called with the
/// number of parts that are done, and `total`.
///
/// The threads are the work's own: those of a pool that lives on are not there in a process that forked.
pub fn work<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    (callback, total): (Option<Py<PyAny>>, u64),
    job: impl FnOnce(&Progress) -> T + Send,
) -> PyResult<T> {
    if callback
        .as_ref()
        .is_some_and(|callback| !callback.bind(py).is_callable())
    {
        let message =
            "progress must be a function of two numbers, what is done and what there is to do";
        return Err(error::argument("progress", message));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    let pool = pool
        .build()
        .map_err(|cause| error::run(&format!("no threads: {cause}")))?;
    let progress = Progress::default();
    let tell = |py: Python<'_>, reported: &mut u64| -> PyResult<()> {
        py.check_signals()?;
        let done = progress.done.load(Ordering::Relaxed);
        match &callback {
            Some(callback) if done != *reported => {
                *reported = done;
                callback.call1(py, (done, total)).map(|_| ())
            }
            _ => Ok(()),
        }
    };
    let mut reported = 0;
    let (answer, stopped) = py.detach(|| {
        std::thread::scope(|scope| {
            let (over, is_over) = channel::<()>();
            let progress = &progress;
            let worker = scope.spawn(move || {
                let answer = catch_unwind(AssertUnwindSafe(|| pool.install(|| job(progress))));
                drop(over);
                answer
            });
            let mut stopped = None;
            while let Err(RecvTimeoutError::Timeout) = is_over.recv_timeout(LOOK) {
                if stopped.is_none()
                    && let Err(error) = Python::attach(|py| tell(py, &mut reported))
                {
                    progress.stop.store(true, Ordering::Relaxed);
                    stopped = Some(error);
                }
            }
            (worker.join(), stopped)
        })
    });
    if let Some(error) = stopped {
        return Err(error);
    }
    let answer = answer.and_then(|answer| answer);
    let answer = answer.unwrap_or_else(|panic| resume_unwind(panic));
    tell(py, &mut reported)?;
    Ok(answer)
}
