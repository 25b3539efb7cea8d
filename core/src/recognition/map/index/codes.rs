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
        for (seq, anchor) in concerned.iter().filter_map(|seq| Some((*seq, self.anchors.get(seq.index())?))) {
            for observation in anchor.observations.values() {
                self.readings.remove(&anchor.class, seq, observation, &mut touched.parsed);
            }
        }
        self.readings.set_codes(classes);
        for (seq, anchor) in concerned.iter().filter_map(|seq| Some((*seq, self.anchors.get(seq.index())?))) {
            for observation in anchor.observations.values() {
                self.readings.add(&anchor.class, seq, observation, &mut touched.parsed);
            }
            // An equal text may be parsed otherwise now.
            self.texts.set(seq, "", None);
        }
        touched.stale.extend(concerned);
    }
}
