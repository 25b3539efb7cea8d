//! A silent model, for tests: it fills a role and never answers.

use futures_util::future::BoxFuture;

use crate::llm::port::{Fault, Model, Question, Reply, Role};

/// A model that never answers.
#[derive(Debug)]
pub struct Silent {
    /// Whether it is a model for images.
    pub sees: bool,
}

impl Model for Silent {
    fn name(&self) -> &'static str {
        "silent"
    }

    fn identity(&self) -> String {
        "silent".to_owned()
    }

    fn can(&self, role: Role) -> bool {
        (role == Role::Vision) == self.sees
    }

    fn answer<'a>(&'a self, _: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>> {
        Box::pin(std::future::pending())
    }
}
