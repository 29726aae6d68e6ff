//! Long work: without the interpreter lock, with progress, and stopped by Ctrl-C or by an exception of what it calls.

use crate::errors::RadsightError;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

/// How often the main thread checks for signals and reports progress.
const INTERVAL: Duration = Duration::from_millis(50);

/// How far work is, and whether it is to stop.
#[derive(Default)]
pub(crate) struct Watch {
    /// Bits of the share that is done.
    done: AtomicU64,
    stop: AtomicBool,
}

impl Watch {
    pub(crate) fn set_done(&self, share: f64) {
        self.done.store(share.to_bits(), Ordering::Relaxed);
    }

    fn done(&self) -> f64 {
        f64::from_bits(self.done.load(Ordering::Relaxed))
    }
}

impl radsight::Progress for Watch {
    fn report(&self, done: u64, total: u64) {
        self.set_done(done as f64 / total.max(1) as f64);
    }

    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// The first exception that Python code raised which the work called.
#[derive(Clone, Debug, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    pub(crate) fn set(&self, error: PyErr) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }

    pub(crate) fn take(&self) -> Option<PyErr> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn is_set(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }
}

/// Runs work on another thread, and on so many where that is said, until it is done. Gives what was raised meanwhile.
pub(crate) fn supervised<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
    raised: &Raised,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<T> {
    if let Some(progress) =
        progress.as_ref().map(|progress| progress.bind(py)).filter(|progress| !progress.is_callable())
    {
        let kind = progress.get_type().name()?;
        return Err(PyTypeError::new_err(format!("progress is {kind}, expected a callable of one number, 0 to 1")));
    }
    let pool = threads.map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build()).transpose();
    let pool = pool.map_err(|error| RadsightError::new_err(error.to_string()))?;
    let watch = Watch::default();
    let (result, heard) = py.detach(|| {
        std::thread::scope(|scope| {
            let (ended, end) = mpsc::channel::<()>();
            let (watch, pool) = (&watch, &pool);
            let worker = scope.spawn(move || {
                // Dropped at the end, after a panic too.
                let _ended = ended;
                match pool {
                    Some(pool) => pool.install(|| work(watch)),
                    None => work(watch),
                }
            });
            let mut heard = Ok(());
            while end.recv_timeout(INTERVAL) == Err(mpsc::RecvTimeoutError::Timeout) {
                if heard.is_ok() {
                    heard = tell(progress.as_ref(), watch.done());
                }
                if heard.is_err() || raised.is_set() {
                    watch.stop.store(true, Ordering::Relaxed);
                }
            }
            (worker.join(), heard)
        })
    });
    let result = result.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    heard?;
    match raised.take() {
        Some(error) => Err(error),
        None => tell(progress.as_ref(), 1.0).map(|()| result),
    }
}

/// Lets signals raise, and calls who wants to hear of progress.
fn tell(progress: Option<&Py<PyAny>>, done: f64) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        progress.map_or(Ok(()), |progress| progress.call1(py, (done,)).map(drop))
    })
}

/// The error of work that was stopped without an exception, which does not happen.
pub(crate) fn stopped() -> PyErr {
    RadsightError::new_err("the work was stopped")
}
