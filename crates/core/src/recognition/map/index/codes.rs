//! Classes of codes: when a map's client changes which these are, all that was read of them is read anew.

use super::map_index::MapIndex;
use super::touched::Touched;
use crate::domain::ids::AnchorSeq;

impl MapIndex {
    /// Takes the classes whose texts are codes. Anchors of classes whose rule changes are described anew.
    pub(super) fn set_code_classes(&mut self, classes: &[String], touched: &mut Touched) {
        let is_now = |class: &str| classes.iter().any(|code| code == class);
        let concerned = self
            .anchors
            .iter()
            .filter(|(_, anchor)| self.readings.is_of_codes(&anchor.class) != is_now(&anchor.class));
        let concerned: Vec<AnchorSeq> = concerned.map(|(seq, _)| AnchorSeq(seq as u32)).collect();
        // Under the rule by which they were counted.
        self.count_readings(&concerned, touched, false);
        self.readings.set_codes(classes);
        self.count_readings(&concerned, touched, true);
        for seq in &concerned {
            // An equal text may be parsed otherwise now.
            self.texts.set(*seq, "", None);
        }
        touched.stale.extend(concerned);
    }

    fn count_readings(&mut self, anchors: &[AnchorSeq], touched: &mut Touched, is_there: bool) {
        for (seq, anchor) in anchors.iter().filter_map(|seq| Some((*seq, self.anchors.get(seq.index())?))) {
            for observation in anchor.observations.values() {
                self.readings.count(&anchor.class, seq, observation, &mut touched.parsed, is_there);
            }
        }
    }
}
