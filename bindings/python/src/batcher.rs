//! Batches: the questions of many threads become one call of Python.
//!
//! A thread that has a question waits for its answer. One of the threads that wait takes the interpreter lock and answers all of them.
//! It is the one that completes half of the threads that ask: while it is in Python, the other half computes.

use pyo3::prelude::*;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Threads of a scene whose materials are Python's. Most of them wait at any time.
pub(crate) const THREADS: usize = 64;

/// Time without a further question after which those that wait are answered.
const PATIENCE: Duration = Duration::from_micros(300);

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
    /// Whether a thread is about to take the batch.
    is_led: bool,
}

/// What the thread of a question does about its batch.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    /// Takes and answers it.
    Leads,
    /// The same, if no other question arrives in time.
    KeepsTime,
    Waits,
}

impl<Question, Answer> Default for Batcher<Question, Answer> {
    fn default() -> Self {
        Batcher(Mutex::new(Queue { waiting: Vec::new(), asked: 0, last_sizes: [0; 2], is_led: false }))
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
                Role::Leads => self.lead(&answer_all),
                Role::Waits => return answer.recv().ok(),
                Role::KeepsTime => {}
            }
            match answer.recv_timeout(PATIENCE) {
                Ok(answer) => return Some(answer),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) => (role, asked) = self.after_patience(asked),
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
            _ if is_half && !queue.is_led => Role::Leads,
            1 => Role::KeepsTime,
            _ => Role::Waits,
        };
        queue.is_led |= role == Role::Leads;
        (role, queue.asked)
    }

    /// The further role of the thread that keeps time, and the number of questions that it knows of.
    fn after_patience(&self, asked: u64) -> (Role, u64) {
        let mut queue = self.queue();
        let leads = !queue.is_led && queue.asked == asked;
        queue.is_led |= leads;
        (if leads { Role::Leads } else { Role::KeepsTime }, queue.asked)
    }

    /// Answers the batch. Who gets no answer hears that its sender is gone.
    fn lead(&self, answer_all: impl Fn(Python<'_>, Vec<Question>) -> Vec<Answer>) {
        let (senders, answers) = Python::attach(|py| {
            // Whoever asks while this thread waits for the interpreter belongs to the batch.
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
        queue.is_led = false;
        queue.last_sizes = [queue.waiting.len(), queue.last_sizes[0]];
        std::mem::take(&mut queue.waiting)
    }
}
