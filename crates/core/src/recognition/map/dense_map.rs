//! Values by dense number, where a number is never given twice.
//!
//! A robot on patrol adds keyframes and culls as many, for years. Numbers only grow, and one slot for each would, too; so
//! the slots lie in pages, and a page that holds nothing takes a pointer.

use std::fmt;

/// Slots of a page: few, since one value keeps the whole page, and enough that the pointers to the pages do not count.
const PAGE: usize = 64;

/// A table by dense number. Two are equal when they hold the same values under the same numbers.
#[derive(Clone)]
pub struct DenseMap<T> {
    pages: Vec<Option<Box<Page<T>>>>,
}

#[derive(Clone)]
struct Page<T> {
    /// How many of the slots hold a value; never zero.
    held: usize,
    /// Boxed: most slots of an old page are empty.
    slots: [Option<Box<T>>; PAGE],
}

impl<T> DenseMap<T> {
    /// Returns the value under a number.
    pub fn get(&self, number: usize) -> Option<&T> {
        self.pages.get(number / PAGE)?.as_ref()?.slots[number % PAGE].as_deref()
    }

    /// Returns the value under a number, to be changed.
    pub fn get_mut(&mut self, number: usize) -> Option<&mut T> {
        self.pages.get_mut(number / PAGE)?.as_mut()?.slots[number % PAGE].as_deref_mut()
    }

    /// Puts a value under a number, in place of the one that was there.
    pub fn insert(&mut self, number: usize, value: T) {
        let page = self.page(number);
        let slot = &mut page.slots[number % PAGE];
        page.held += usize::from(slot.is_none());
        *slot = Some(Box::new(value));
    }

    /// Returns the value under a number, made by `value` if there is none.
    pub fn get_or_insert_with(&mut self, number: usize, value: impl FnOnce() -> T) -> &mut T {
        let page = self.page(number);
        let slot = &mut page.slots[number % PAGE];
        page.held += usize::from(slot.is_none());
        slot.get_or_insert_with(|| Box::new(value()))
    }

    /// Takes the value from under a number.
    pub fn remove(&mut self, number: usize) -> Option<T> {
        let place = self.pages.get_mut(number / PAGE)?;
        let page = place.as_mut()?;
        let value = page.slots[number % PAGE].take()?;
        page.held -= 1;
        if page.held == 0 {
            *place = None;
        }
        Some(*value)
    }

    /// Returns the values with their numbers, ascending.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &T)> {
        self.iter_from(0)
    }

    /// Those of them whose numbers are at least this one.
    pub fn iter_from(&self, first: usize) -> impl Iterator<Item = (usize, &T)> {
        let pages = self.pages.iter().enumerate().skip(first / PAGE);
        let held = pages.filter_map(|(at, page)| Some((at, page.as_ref()?)));
        held.flat_map(|(at, page)| {
            let slots = page.slots.iter().enumerate();
            slots.filter_map(move |(slot, value)| Some((at * PAGE + slot, value.as_deref()?)))
        })
        .skip_while(move |(number, _)| *number < first)
    }

    /// Returns the values, by ascending number.
    pub fn values(&self) -> impl Iterator<Item = &T> {
        self.iter().map(|(_, value)| value)
    }

    fn page(&mut self, number: usize) -> &mut Page<T> {
        let at = number / PAGE;
        if self.pages.len() <= at {
            self.pages.resize_with(at + 1, || None);
        }
        self.pages[at].get_or_insert_with(|| Box::new(Page { held: 0, slots: [const { None }; PAGE] }))
    }
}

impl<T> Default for DenseMap<T> {
    fn default() -> Self {
        Self { pages: Vec::new() }
    }
}

impl<T: PartialEq> PartialEq for DenseMap<T> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl<T: fmt::Debug> fmt::Debug for DenseMap<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_map().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn it_is_a_map_by_number_whatever_comes_and_goes(
            steps in prop::collection::vec((0usize..300, prop::option::of(any::<u8>())), 0..200),
        ) {
            let (mut table, mut model) = (DenseMap::default(), BTreeMap::new());
            for (number, value) in steps {
                if let Some(value) = value {
                    table.insert(number, value);
                    model.insert(number, value);
                } else {
                    prop_assert_eq!(table.remove(number), model.remove(&number));
                }
                prop_assert_eq!(table.get(number), model.get(&number));
            }
            prop_assert!(table.iter().eq(model.iter().map(|(number, value)| (*number, value))));
            for first in [0, 63, 64, 65, 200, 1000] {
                let from = model.range(first..).map(|(number, value)| (*number, value));
                prop_assert!(table.iter_from(first).eq(from));
            }
            let pages = table.pages.iter().flatten().count();
            let needed: std::collections::BTreeSet<_> = model.keys().map(|number| number / PAGE).collect();
            prop_assert_eq!(pages, needed.len());
        }
    }

    #[test]
    fn tables_are_equal_by_what_they_hold() {
        let (mut one, mut other) = (DenseMap::default(), DenseMap::default());
        one.insert(3, 'a');
        one.insert(1000, 'b');
        one.remove(1000);
        *other.get_or_insert_with(3, char::default) = 'a';
        assert_eq!(one, other);
        other.insert(4, 'a');
        assert_ne!(one, other);
    }
}
