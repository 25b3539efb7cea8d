//! List: one part of something long, and where the next part starts.

use revisit_core::domain::report::Page;
use revisit_shapes::answer;

use super::anchor::AnchorView;
use super::backup::BackupView;
use super::key::KeyView;
use super::keyframe::{CovisibleView, KeyframeLine};
use super::listed_verdict::ListedVerdictView;
use super::loops::LoopView;
use super::map::MapView;
use super::release::ReleaseView;
use super::session::SessionView;

// One struct for each list and no generic one: generators name a schema after its type, and `List_AnchorView` is no name.
macro_rules! lists {
    ($($(#[doc = $doc:literal])+ $name:ident of $item:ident;)+) => {$(
        $(#[doc = $doc])+
        #[answer]
        pub struct $name {
            /// The items of this part.
            pub items: Vec<$item>,
            /// The cursor of the next part; null after the last one.
            #[schema(required)]
            #[null]
            pub next_cursor: Option<String>,
        }

        impl<T: Into<$item>> From<Page<T>> for $name {
            fn from(page: Page<T>) -> Self {
                Self { items: page.items.into_iter().map(Into::into).collect(), next_cursor: page.next_cursor }
            }
        }
    )+};
}

/// Lists at a version of the map.
macro_rules! lists_at {
    ($($(#[doc = $doc:literal])+ $name:ident of $item:ident;)+) => {$(
        $(#[doc = $doc])+
        #[answer]
        pub struct $name {
            /// The map's version.
            pub map_version: u64,
            /// The items of this part.
            pub items: Vec<$item>,
            /// The cursor of the next part; null after the last one.
            #[schema(required)]
            #[null]
            pub next_cursor: Option<String>,
        }

        impl<T: Into<$item>> From<(u64, Page<T>)> for $name {
            fn from((map_version, page): (u64, Page<T>)) -> Self {
                let items = page.items.into_iter().map(Into::into).collect();
                Self { map_version, items, next_cursor: page.next_cursor }
            }
        }
    )+};
}

lists_at! {
    /// Keyframes, in order of arrival.
    KeyframeList of KeyframeLine;
    /// Anchors, oldest first.
    AnchorList of AnchorView;
    /// Sessions, in order of appearance.
    SessionList of SessionView;
    /// Confirmed loops, oldest first.
    LoopList of LoopView;
    /// Covisible keyframes; this list comes in one part.
    CovisibleList of CovisibleView;
}

lists! {
    /// Verdicts, the newest first.
    VerdictList of ListedVerdictView;
    /// Releases of a map, by name.
    ReleaseList of ReleaseView;
    /// Keys, in order of creation, revoked ones among them.
    KeyList of KeyView;
    /// Backups, the newest first.
    BackupList of BackupView;
}

/// Maps, by id.
#[answer]
pub struct MapList {
    /// The items of this part.
    pub items: Vec<MapView>,
    /// The cursor of the next part; null after the last one.
    #[schema(required)]
    #[null]
    pub next_cursor: Option<String>,
    /// The maps that the key covers, as patterns; left out where it covers every map.
    pub covered: Option<Vec<String>>,
}

impl MapList {
    /// One part of the list, as a key sees it that covers these maps.
    pub fn of<T: Into<MapView>>(page: Page<T>, covered: Option<Vec<String>>) -> Self {
        let items = page.items.into_iter().map(Into::into).collect();
        Self { items, next_cursor: page.next_cursor, covered }
    }
}
