//! The two versions of a map that are compared.

use utoipa::IntoParams;

use crate::api::decoding::read::{self, Decode, Node};
use crate::api::limits;
use crate::domain::ids::ReleaseName;

/// The parameters of changes.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "documents what the reader reads")]
pub struct ChangesSearch {
    /// The release that is the earlier version.
    #[param(min_length = 1, max_length = 128, pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$")]
    since: String,
    /// The release that is the later version; left out: the map as it stands.
    #[param(min_length = 1, max_length = 128, pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$")]
    until: Option<String>,
    /// Maximum number of items of each change.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    limit: Option<u32>,
}

/// The two versions that are compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChangesQuery {
    /// The earlier one.
    pub since: ReleaseName,
    /// The later one, if it is a release.
    pub until: Option<ReleaseName>,
    /// Items of each change, at most.
    pub limit: usize,
}

impl Decode for ChangesQuery {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["since", "until", "limit"])?;
        let since = query.required("since", read::id);
        let until = query.optional("until", read::id);
        let limit = query.optional("limit", |node| node.digits(limits::PAGE));
        Some(Self {
            since: since?,
            until: until?,
            limit: limit?.map_or(limits::PAGE_DEFAULT, |limit| limit as usize),
        })
    }
}
