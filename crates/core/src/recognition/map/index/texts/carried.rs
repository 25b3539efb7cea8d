//! Texts that come and go with the objects that carry them.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::matches::Matches;
use super::text_id::TextId;
use super::text_index::{Node, TextIndex};
use crate::domain::ids::AnchorSeq;
use crate::recognition::map::index::reverse::remove_last;
use crate::semantics::Text;

impl TextIndex {
    /// The object carries this text now, or none that counts.
    pub fn set(&mut self, object: AnchorSeq, class: &str, text: Option<&Arc<Text>>) {
        let known = text.and_then(|text| self.find(class, text));
        if known.is_some() && self.text_of.get(&object) == known.as_ref() {
            return;
        }
        self.unset(object);
        let Some(text) = text else { return };
        let id = known.unwrap_or_else(|| self.add(class, text));
        self.node_mut(id).objects.insert(object);
        self.text_of.insert(object, id);
    }

    /// Lists the match of two texts, or no longer, after a model has judged them.
    pub(super) fn rejudge(&mut self, class: &str, pair: [&str; 2]) {
        let [Some(a), Some(b)] = pair.map(|text| self.find_normalised(class, text)) else { return };
        if a == b {
            return;
        }
        let verdict = self.judge(&self.node(a).text, b);
        let max = self.listed_max;
        for (id, other) in [(a, b), (b, a)] {
            let matches = &mut self.node_mut(id).matches;
            match &verdict {
                Some(verdict) => matches.insert(other, verdict.clone(), max),
                None => matches.remove(other),
            }
        }
    }

    fn add(&mut self, class: &str, text: &Arc<Text>) -> TextId {
        let id = self.free.pop().unwrap_or(TextId(self.nodes.len()));
        if id.0 == self.nodes.len() {
            self.nodes.push(None);
        }
        let (mut matches, max) = (Matches::none(), self.listed_max);
        for other in self.partners(class, text) {
            // Neither would list the other.
            if matches.is_crowded() && self.node(other).matches.is_crowded() {
                continue;
            }
            self.judged_pairs += 1;
            if let Some(verdict) = self.judge(text, other) {
                self.node_mut(other).matches.insert(id, verdict.clone(), max);
                matches.insert(other, verdict, max);
            }
        }
        for key in text.keys() {
            let sharing = self.by_key.entry(*key).or_default();
            sharing.texts.push(id);
            sharing.undecided += usize::from(text.is_undecided_by_identity());
        }
        let identity = self.identities.join(class, text);
        for word in text.specific_words() {
            self.by_word.entry(word.into()).or_default().insert(id);
        }
        self.by_text.insert((class.into(), text.normalised().into()), id);
        self.nodes[id.0] = Some(Node {
            class: class.into(),
            text: text.clone(),
            objects: BTreeSet::new(),
            matches,
            identity,
        });
        id
    }

    fn unset(&mut self, object: AnchorSeq) {
        let Some(id) = self.text_of.remove(&object) else { return };
        let node = self.node_mut(id);
        node.objects.remove(&object);
        if !node.objects.is_empty() {
            return;
        }
        // Nobody carries the text any more: its matches are withdrawn with it.
        let Some(node) = self.nodes[id.0].take() else { return };
        self.identities.leave(&node.class, &node.text);
        for key in node.text.keys() {
            if let Some(sharing) = self.by_key.get_mut(key) {
                sharing.texts.retain(|listed| *listed != id);
                sharing.undecided -= usize::from(node.text.is_undecided_by_identity());
                if sharing.texts.is_empty() {
                    self.by_key.remove(key);
                }
            }
        }
        for word in node.text.specific_words() {
            if remove_last(self.by_word.get_mut(word), &id) {
                self.by_word.remove(word);
            }
        }
        self.by_text.remove(&(node.class.clone(), node.text.normalised().into()));
        let others = match node.matches {
            Matches::Listed(list) => list.into_keys().collect(),
            Matches::Crowded => self.partners(&node.class, &node.text),
        };
        for other in others {
            self.node_mut(other).matches.remove(id);
        }
        self.free.push(id);
    }
}
