//! Batches: the questions of many threads become one call of Python.
//!
//! A thread that has a question waits for its answer. One of the waiting threads takes the interpreter lock and answers the whole
//! batch: the thread whose question makes it half as large as the number of threads. While this thread is in Python, the other half
//! computes.

use pyo3::prelude::*;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Number of threads that trace a scene with materials in Python. Most of them wait at any time.
pub(crate) const THREADS: usize = 64;

/// Time without a further question after which an incomplete batch is answered.
const FLUSH_TIMEOUT: Duration = Duration::from_micros(300);

/// Gathers questions into batches.
#[derive(Debug)]
pub(crate) struct Batcher<Question, Answer>(Mutex<Queue<Question, Answer>>);

#[derive(Debug)]
struct Queue<Question, Answer> {
    waiting: Vec<(Question, Sender<Answer>)>,
    /// Number of all questions so far.
    asked: u64,
    /// Sizes of the last two batches; together about the number of threads that ask.
    last_sizes: [usize; 2],
    /// Whether a thread is about to answer the batch.
    flush_pending: bool,
}

/// The role of a question's thread in its batch.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    /// Takes and answers the batch.
    Flush,
    /// The same, if no other question arrives before the timeout.
    Time,
    /// Waits for the answer.
    Wait,
}

impl<Question, Answer> Default for Batcher<Question, Answer> {
    fn default() -> Self {
        Batcher(Mutex::new(Queue { waiting: Vec::new(), asked: 0, last_sizes: [0; 2], flush_pending: false }))
    }
}

impl<Question, Answer> Batcher<Question, Answer> {
    /// The answer to a question; `None` if `answer_all` gave none. That answers a batch in its order.
    pub(crate) fn ask(
        &self,
        question: Question,
        answer_all: impl Fn(Python<'_>, Vec<Question>) -> Vec<Answer>,
    ) -> Option<Answer> {
        let (sender, answer) = mpsc::channel();
        let (mut role, mut asked) = self.push(question, sender);
        loop {
            match role {
                Role::Flush => self.flush(&answer_all),
                Role::Wait => return answer.recv().ok(),
                Role::Time => {}
            }
            match answer.recv_timeout(FLUSH_TIMEOUT) {
                Ok(answer) => return Some(answer),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) => (role, asked) = self.after_timeout(asked),
            }
        }
    }

    fn queue(&self) -> MutexGuard<'_, Queue<Question, Answer>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn push(&self, question: Question, sender: Sender<Answer>) -> (Role, u64) {
        let mut queue = self.queue();
        queue.waiting.push((question, sender));
        queue.asked += 1;
        let is_half = 2 * queue.waiting.len() >= queue.last_sizes.iter().sum();
        let role = match queue.waiting.len() {
            _ if is_half && !queue.flush_pending => Role::Flush,
            1 => Role::Time,
            _ => Role::Wait,
        };
        queue.flush_pending |= role == Role::Flush;
        (role, queue.asked)
    }

    /// The next role of the thread that observes the timeout, and the number of questions so far.
    fn after_timeout(&self, asked: u64) -> (Role, u64) {
        let mut queue = self.queue();
        let flushes = !queue.flush_pending && queue.asked == asked;
        queue.flush_pending |= flushes;
        (if flushes { Role::Flush } else { Role::Time }, queue.asked)
    }

    /// Answers the batch. A thread without an answer finds its channel closed.
    fn flush(&self, answer_all: impl Fn(Python<'_>, Vec<Question>) -> Vec<Answer>) {
        let (senders, answers) = Python::attach(|py| {
            // Queries made while this thread waits for the interpreter belong to the batch.
            let (questions, senders): (Vec<_>, Vec<_>) = self.take().into_iter().unzip();
            (senders, answer_all(py, questions))
        });
        for (sender, answer) in senders.into_iter().zip(answers) {
            // A thread waits for its answer until the sender is gone.
            let _ = sender.send(answer);
        }
    }

    fn take(&self) -> Vec<(Question, Sender<Answer>)> {
        let mut queue = self.queue();
        queue.flush_pending = false;
        queue.last_sizes = [queue.waiting.len(), queue.last_sizes[0]];
        std::mem::take(&mut queue.waiting)
    }
}
