//! The release of a map that is read.

use revisit_shapes::params;

use crate::domain::ids::ReleaseName;

/// The release that is read, if one was named.
#[params]
pub struct ReleaseQuery {
    /// The release that is read; left out: the map as it stands.
    #[id]
    pub release: Option<ReleaseName>,
}
