//! The worker's jobs under way: each is named when it ends, however it ended.

use tokio::task::JoinSet;
use tokio_util::task::AbortOnDropHandle;

use crate::llm::port::Fault;
use crate::recognition::anchors::description_tasks::DescriptionTask;
use crate::store::MapKey;

/// The jobs under way, each of them [`named`].
pub(in crate::engine) type Jobs = JoinSet<Done>;

/// A job that ended.
#[derive(Debug)]
pub(in crate::engine) struct Done {
    pub map: MapKey,
    pub lack: DescriptionTask,
    pub result: Result<(), Fault>,
}

/// Does a job. One that panics fails like any other, and is tried again like any other.
pub(in crate::engine) async fn named(
    map: MapKey,
    lack: DescriptionTask,
    job: impl Future<Output = Result<(), Fault>> + Send + 'static,
) -> Done {
    let result = AbortOnDropHandle::new(tokio::spawn(job)).await.unwrap_or_else(|error| {
        tracing::error!(%error, "a job broke off");
        Err(Fault::Broken)
    });
    Done { map, lack, result }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_job_that_panics_is_named_as_failed() {
        let lack = |text: &str| DescriptionTask::Information { class: "sign".into(), text: text.into() };
        let mut jobs = Jobs::default();
        jobs.spawn(named(7, lack("panics"), async { panic!("a bug") }));
        let done = jobs.join_next().await.expect("it ends").expect("it is named");
        assert_eq!((done.map, done.lack, done.result), (7, lack("panics"), Err(Fault::Broken)));
        jobs.spawn(named(7, lack("works"), async { Ok(()) }));
        assert_eq!(jobs.join_next().await.expect("it ends").expect("it is named").result, Ok(()));
        assert!(jobs.is_empty() && jobs.join_next().await.is_none());
    }
}
