//! Held jobs: those that may wait a moment for more, so as to share a sync with them.
//!
//! A bulk upload decides a line in a fraction of the time of a sync. Committed as they come, three lines shared one. So a
//! line waits until there are enough, a job comes that waits for nothing, somebody waits for a held one, or time is up.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::mpsc;

use super::queue::{Message, Queued};
use crate::StoreError;

/// Jobs that go to the writer together once there are as many.
const HELD_MAX: usize = 64;

/// The longest that a job is held. Whoever waits for one does not wait for this; events of a bulk upload do.
const HELD_TIME: Duration = Duration::from_millis(150);

/// The way to the writer's queue, past the jobs that are held. Order is kept: a job is sent behind all that came before.
#[derive(Clone, Debug)]
pub(super) struct Held {
    batch: Arc<Mutex<Batch>>,
    queue: mpsc::UnboundedSender<Message>,
}

/// The jobs that are held.
#[derive(Debug, Default)]
struct Batch {
    jobs: Vec<Queued>,
    /// How many batches were sent before, so that the time of one does not end the next.
    number: u64,
}

impl Held {
    /// Holds nothing yet.
    pub fn before(queue: mpsc::UnboundedSender<Message>) -> Self {
        Self { batch: Arc::default(), queue }
    }

    /// Sends jobs that wait for nothing, behind those that are held.
    pub fn send(&self, jobs: Vec<Queued>) {
        let mut held = self.lock();
        held.jobs.extend(jobs);
        self.flush(held);
    }

    /// Holds a job, unless there are enough now.
    pub fn hold(&self, job: Queued) {
        let mut held = self.lock();
        held.jobs.push(job);
        let (is_first, number) = (held.jobs.len() == 1, held.number);
        // Nothing sends it later where there is no runtime.
        let runtime = tokio::runtime::Handle::try_current().ok();
        let Some(runtime) = runtime.filter(|_| held.jobs.len() < HELD_MAX) else { return self.flush(held) };
        drop(held);
        if is_first {
            let this = self.clone();
            runtime.spawn(async move {
                tokio::time::sleep(HELD_TIME).await;
                this.release_batch(number);
            });
        }
    }

    /// Sends what is held.
    pub fn release(&self) {
        self.flush(self.lock());
    }

    /// Sends what is held, if it is still this batch.
    fn release_batch(&self, number: u64) {
        let held = self.lock();
        if held.number == number {
            self.flush(held);
        }
    }

    /// Sends a message behind what is held; whether the writer still takes any.
    pub fn send_message(&self, message: Message) -> bool {
        self.release();
        self.queue.send(message).is_ok()
    }

    fn flush(&self, mut held: MutexGuard<'_, Batch>) {
        if held.jobs.is_empty() {
            return;
        }
        held.number += 1;
        let jobs = std::mem::take(&mut held.jobs);
        // Under the lock, which keeps the order.
        let sent = self.queue.send(Message::Jobs(jobs));
        drop(held);
        if let Err(mpsc::error::SendError(Message::Jobs(jobs))) = sent {
            for queued in jobs {
                (queued.done)(Err(StoreError::Closed));
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, Batch> {
        // A list of jobs is whole after each of its operations.
        self.batch.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use tokio::sync::oneshot;

    use super::*;
    use crate::commit::queue::PoisonFlag;
    use crate::jobs::job::Job;

    fn queued(number: i64) -> Queued {
        Queued { job: Job::DeleteMap(number), broken: PoisonFlag::default(), done: Box::new(drop) }
    }

    /// Returns the numbers of the jobs that the writer has been sent, message by message.
    fn sent(queue: &mut mpsc::UnboundedReceiver<Message>) -> Vec<Vec<i64>> {
        let mut messages = Vec::new();
        while let Ok(Message::Jobs(jobs)) = queue.try_recv() {
            let number = |queued: &Queued| match queued.job {
                Job::DeleteMap(number) => number,
                _ => unreachable!("only deletions were queued"),
            };
            messages.push(jobs.iter().map(number).collect());
        }
        messages
    }

    // One thread: what sends held jobs after a time runs only where a test waits.
    #[tokio::test]
    async fn held_jobs_go_together_once_they_are_enough_and_keep_their_order() {
        let (sender, mut queue) = mpsc::unbounded_channel();
        let held = Held::before(sender);
        (0..150).for_each(|number| held.hold(queued(number)));
        let messages = sent(&mut queue);
        assert_eq!(messages.iter().map(Vec::len).collect::<Vec<_>>(), [HELD_MAX; 2]);
        held.release();
        assert!(messages.into_iter().chain(sent(&mut queue)).flatten().eq(0..150));
    }

    #[tokio::test]
    async fn a_job_that_waits_for_nothing_takes_along_what_came_before_it() {
        let (sender, mut queue) = mpsc::unbounded_channel();
        let held = Held::before(sender);
        held.hold(queued(1));
        held.hold(queued(2));
        held.send(vec![queued(3)]);
        assert_eq!(sent(&mut queue), [[1, 2, 3]]);
        held.hold(queued(4));
        assert!(held.send_message(Message::Settle(oneshot::channel().0)));
        assert!(matches!(queue.try_recv(), Ok(Message::Jobs(jobs)) if jobs.len() == 1));
        assert!(matches!(queue.try_recv(), Ok(Message::Settle(_))));
    }

    #[tokio::test]
    async fn no_job_is_held_for_longer_than_a_moment() {
        let (sender, mut queue) = mpsc::unbounded_channel();
        let held = Held::before(sender);
        held.hold(queued(1));
        assert_eq!(sent(&mut queue), Vec::<Vec<i64>>::new());
        assert!(matches!(queue.recv().await, Some(Message::Jobs(jobs)) if jobs.len() == 1));
        held.hold(queued(2));
        drop(queue);
        let (answered, heard) = oneshot::channel();
        let done = Box::new(move |result| drop(answered.send(result)));
        held.send(vec![Queued { done, ..queued(3) }]);
        assert!(matches!(heard.await, Ok(Err(StoreError::Closed))), "a writer that is gone takes no job");
    }

    #[tokio::test]
    async fn the_time_of_a_batch_that_was_sent_does_not_end_the_next() {
        let (sender, mut queue) = mpsc::unbounded_channel();
        let held = Held::before(sender);
        held.hold(queued(1));
        let first = held.lock().number;
        held.release();
        held.hold(queued(2));
        held.release_batch(first);
        assert_eq!(sent(&mut queue), [[1]]);
        held.release_batch(first + 1);
        assert_eq!(sent(&mut queue), [[2]]);
    }

    #[test]
    fn without_a_runtime_nothing_is_held() {
        let (sender, mut queue) = mpsc::unbounded_channel();
        Held::before(sender).hold(queued(1));
        assert_eq!(sent(&mut queue), [[1]]);
    }
}
