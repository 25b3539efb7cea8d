//! The sum for a place where a camera without a pose may be, against one other place (M56).
//!
//! The terms and their weights are those of a loop. Two things differ. Nothing is known of the way here, and the place may be
//! in no map: so a view that explains nothing counts against a place, and one name by itself locates none. And other maps, and
//! places that nobody has mapped, are looked at for the same view, so that what only this place explains counts beyond what a
//! copy might show.

use super::log_odds::LogOdds;
use super::sum::{Sum, explained};
use super::weights;
use crate::domain::counted::counted;
use crate::domain::verdict::EvidenceKind;

/// The evidence for a place, and for a rival.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaceBet<'a> {
    /// The cells of the view that it explains, and the rival does not.
    pub cells: usize,
    /// Names that agree, hang in one place only, and do not agree with the rival.
    pub names: Vec<&'a str>,
    /// Such names that agree with the rival, and not with this place.
    pub names_of_rival: Vec<&'a str>,
    /// The number of such names that agree with both.
    pub shared: usize,
    /// Pairs of names that exclude each other at the same relative place.
    pub differing: usize,
    /// Whether a view or a pose from anchors puts the camera somewhere: else one name says that it is near, and no more.
    pub is_placed: bool,
}

impl PlaceBet<'_> {
    /// Returns the sum.
    pub fn sum(&self) -> Sum {
        let mut sum = Sum::default();
        for name in &self.names {
            sum.add(EvidenceKind::Name, Vec::new(), (*name).to_owned(), weights::NAME);
        }
        if self.differing > 0 {
            let about = counted(self.differing, "name");
            sum.add(EvidenceKind::OtherName, Vec::new(), about, weights::OTHER_NAME * self.differing);
        }
        let most = if self.is_placed || self.names.len() > 1 { weights::HERE } else { weights::NEAR };
        sum.limit_to(most);
        // A name that both share says that it is one of the two: then the difference need not bear out that as well.
        let unmapped = if self.shared > 0 { explained(0) } else { LogOdds::EVEN };
        sum.add(
            EvidenceKind::View,
            Vec::new(),
            counted(self.cells, "cell"),
            explained(self.cells) - unmapped,
        );
        for name in &self.names_of_rival {
            sum.add(EvidenceKind::Rival, Vec::new(), (*name).to_owned(), -weights::NAME);
        }
        sum
    }
}
