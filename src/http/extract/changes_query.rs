//! The two versions of a map that are compared.

use revisit_shapes::params;

use crate::domain::ids::ReleaseName;

/// The two versions that are compared.
#[params]
pub struct ChangesQuery {
    /// The release that is the earlier version.
    #[id]
    pub since: ReleaseName,
    /// The release that is the later version; left out: the map as it stands.
    #[id]
    pub until: Option<ReleaseName>,
    /// Maximum number of items of each change.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    pub limit: usize,
}
