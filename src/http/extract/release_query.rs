//! The release of a map that is read.

use utoipa::IntoParams;

use crate::api::decoding::read::{self, Decode, Node};
use crate::domain::ids::ReleaseName;

/// The parameter that names a release.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "documents what the reader reads")]
pub struct ReleaseSearch {
    /// The release that is read; left out: the map as it stands.
    #[param(min_length = 1, max_length = 128, pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$")]
    release: Option<String>,
}

/// The release that is read, if one was named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReleaseQuery {
    /// The release.
    pub release: Option<ReleaseName>,
}

impl Decode for ReleaseQuery {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["release"])?;
        Some(Self { release: query.optional("release", read::id)? })
    }
}
