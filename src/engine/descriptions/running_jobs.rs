//! The worker's jobs under way: each is named when it ends, however it ended.

use std::collections::HashMap;

use tokio::task::{Id, JoinSet};

use crate::llm::port::Fault;
use crate::recognition::anchors::description_tasks::DescriptionTask;
use crate::store::MapKey;

/// A job that ended.
#[derive(Debug)]
pub(in crate::engine) struct Done {
    pub map: MapKey,
    pub lack: DescriptionTask,
    pub result: Result<(), Fault>,
}

/// The jobs under way.
#[derive(Default)]
pub(in crate::engine) struct Jobs {
    running: JoinSet<Result<(), Fault>>,
    /// A job that panics returns nothing, so its name is kept here.
    named: HashMap<Id, (MapKey, DescriptionTask)>,
}

impl Jobs {
    /// Starts a job.
    pub fn begin(
        &mut self,
        map: MapKey,
        lack: DescriptionTask,
        job: impl Future<Output = Result<(), Fault>> + Send + 'static,
    ) {
        let id = self.running.spawn(job).id();
        self.named.insert(id, (map, lack));
    }

    /// Waits for the next job that ends; `None` if there is none. A job that panicked failed like any other, and is
    /// tried again like any other.
    pub async fn next(&mut self) -> Option<Done> {
        loop {
            let (id, result) = match self.running.join_next_with_id().await? {
                Ok((id, result)) => (id, result),
                Err(error) => {
                    tracing::error!(%error, "a job broke off");
                    (error.id(), Err(Fault::Broken))
                }
            };
            if let Some((map, lack)) = self.named.remove(&id) {
                return Some(Done { map, lack, result });
            }
        }
    }

    /// Returns how many jobs are under way.
    pub fn len(&self) -> usize {
        self.running.len()
    }

    /// Whether no job is under way.
    pub fn is_empty(&self) -> bool {
        self.running.is_empty()
    }

    /// Breaks off every job.
    pub fn abort_all(&mut self) {
        self.running.abort_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_job_that_panics_is_named_as_failed() {
        let lack = |text: &str| DescriptionTask::Information { class: "sign".into(), text: text.into() };
        let mut jobs = Jobs::default();
        jobs.begin(7, lack("panics"), async { panic!("a bug") });
        let done = jobs.next().await.expect("it ends");
        assert_eq!((done.map, done.lack, done.result), (7, lack("panics"), Err(Fault::Broken)));
        jobs.begin(7, lack("works"), async { Ok(()) });
        assert_eq!(jobs.next().await.expect("it ends").result, Ok(()));
        assert!(jobs.is_empty() && jobs.next().await.is_none());
    }
}
