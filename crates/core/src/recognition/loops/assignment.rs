//! Assignment by maximum weight: each row takes at most one column, each column at most one row.
//!
//! Rows and columns that no chain of possible pairs joins do not compete, so each such component is assigned by itself. Of
//! two maps of a hundred anchors, a component has a few.

use std::collections::HashMap;

/// A possible pair: row, column, weight, which is positive and finite.
pub type Edge = (usize, usize, f64);

/// Returns the possible pairs of rows and columns, ascending; `weight` gives the weight of one, or `None`.
pub fn edges(rows: usize, columns: usize, weight: impl Fn(usize, usize) -> Option<f64>) -> Vec<Edge> {
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    all.filter_map(|(row, column)| Some((row, column, weight(row, column)?))).collect()
}

/// Pairs `(row, column)` among the possible ones that maximise the sum of weights, ascending by row. Deterministic in ties.
pub fn assign(edges: &[Edge]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for component in components(edges) {
        let (rows, row_of) = numbered(component.iter().map(|edge| edge.0));
        let (columns, column_of) = numbered(component.iter().map(|edge| edge.1));
        let mut weights = vec![None; rows.len() * columns.len()];
        for (row, column, weight) in component {
            weights[row_of[&row] * columns.len() + column_of[&column]] = Some(weight);
        }
        let found = solve(rows.len(), columns.len(), &weights);
        pairs.extend(found.into_iter().map(|(row, column)| (rows[row], columns[column])));
    }
    pairs.sort_unstable();
    pairs
}

/// Parts edges by what is joined with what.
fn components(edges: &[Edge]) -> Vec<Vec<Edge>> {
    // Of each edge, an earlier one of its component, or itself.
    let mut parent: Vec<usize> = (0..edges.len()).collect();
    let mut first_of_row: HashMap<usize, usize> = HashMap::new();
    let mut first_of_column: HashMap<usize, usize> = HashMap::new();
    for (at, (row, column, _)) in edges.iter().enumerate() {
        let firsts = [*first_of_row.entry(*row).or_insert(at), *first_of_column.entry(*column).or_insert(at)];
        for first in firsts {
            let (a, b) = (root(&mut parent, first), root(&mut parent, at));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut components: Vec<Vec<Edge>> = Vec::new();
    let mut number_of_root: HashMap<usize, usize> = HashMap::new();
    for (at, edge) in edges.iter().enumerate() {
        let number = *number_of_root.entry(root(&mut parent, at)).or_insert(components.len());
        if number == components.len() {
            components.push(Vec::new());
        }
        components[number].push(*edge);
    }
    components
}

fn root(parent: &mut [usize], mut at: usize) -> usize {
    while parent[at] != at {
        parent[at] = parent[parent[at]];
        at = parent[at];
    }
    at
}

/// Returns numbers ascending, each once, and the place of each.
fn numbered(numbers: impl Iterator<Item = usize>) -> (Vec<usize>, HashMap<usize, usize>) {
    let mut ascending: Vec<usize> = numbers.collect();
    ascending.sort_unstable();
    ascending.dedup();
    let place_of = ascending.iter().enumerate().map(|(place, number)| (*number, place)).collect();
    (ascending, place_of)
}

/// A column that a search may end at.
#[derive(Clone, Copy)]
enum Column {
    /// One of the columns given.
    Given(usize),
    /// The row's own, where it stays alone.
    OwnOf(usize),
}

/// Assigns by the Hungarian method with potentials (Kuhn 1955, in the O(n^2 m) form of Jonker and Volgenant). `weights` has
/// the columns of each row in turn.
///
/// A row may stay alone: each has a column of its own at weight zero behind the given ones. No other row can take that, so its
/// potential stays zero, and it is looked at only once a search has come to its row.
fn solve(rows: usize, columns: usize, weights: &[Option<f64>]) -> Vec<(usize, usize)> {
    let costs: Vec<f64> =
        weights.iter().map(|weight| weight.map_or(f64::INFINITY, |weight| -weight)).collect();
    let mut row_potential = vec![0.0; rows];
    let mut column_potential = vec![0.0; columns];
    let mut row_of: Vec<Option<usize>> = vec![None; columns];
    for start in 0..rows {
        // Shortest augmenting path from `start` (Dijkstra over reduced costs).
        let mut slack = vec![f64::INFINITY; columns];
        let mut from: Vec<Option<usize>> = vec![None; columns];
        let mut done = vec![false; columns];
        // The rows that the search has come to, each with the slack of its own column, and the column it was found by.
        let mut reached: Vec<(usize, f64, Option<usize>)> = Vec::new();
        let (mut row, mut last) = (start, None);
        // Each row's potential at the first step makes all its reduced costs finite and comparable.
        let end = loop {
            let mut nearest: Option<usize> = None;
            for (column, cost) in costs[row * columns..][..columns].iter().enumerate() {
                if done[column] {
                    continue;
                }
                let reduced = cost - row_potential[row] - column_potential[column];
                if reduced < slack[column] {
                    slack[column] = reduced;
                    from[column] = last;
                }
                if nearest.is_none_or(|nearest| slack[column].total_cmp(&slack[nearest]).is_lt()) {
                    nearest = Some(column);
                }
            }
            reached.push((row, 0.0 - row_potential[row], last));
            let alone = reached.iter().min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
            let (nearest, step) = match (nearest.map(|column| (column, slack[column])), alone) {
                (Some((column, step)), Some(alone)) if step.total_cmp(&alone.1).is_le() => {
                    (Column::Given(column), step)
                }
                (_, Some((row, step, _))) => (Column::OwnOf(*row), *step),
                (_, None) => unreachable!("the search has come to its start"),
            };
            row_potential[start] += step;
            for column in 0..columns {
                if done[column] {
                    column_potential[column] -= step;
                    if let Some(row) = row_of[column] {
                        row_potential[row] += step;
                    }
                } else {
                    slack[column] -= step;
                }
            }
            for (_, slack, _) in &mut reached {
                *slack -= step;
            }
            let Column::Given(column) = nearest else { break nearest };
            done[column] = true;
            match row_of[column] {
                None => break nearest,
                Some(next) => (row, last) = (next, Some(column)),
            }
        };
        // Turn the path around: each row takes the column that follows on it.
        let mut before = match end {
            Column::Given(column) => {
                let before = from[column];
                row_of[column] = Some(before.map_or(start, |before| row_of[before].unwrap_or(start)));
                before
            }
            Column::OwnOf(row) => {
                reached.iter().find(|reached| reached.0 == row).and_then(|reached| reached.2)
            }
        };
        while let Some(column) = before {
            before = from[column];
            row_of[column] = Some(before.map_or(start, |before| row_of[before].unwrap_or(start)));
        }
    }
    let pairs = row_of.iter().enumerate().filter_map(|(column, row)| Some(((*row)?, column)));
    let mut pairs: Vec<(usize, usize)> = pairs.collect();
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Weights = Vec<Vec<Option<f64>>>;

    fn best_by_trying_all(weights: &Weights, row: usize, taken: &mut Vec<bool>) -> f64 {
        let Some(line) = weights.get(row) else { return 0.0 };
        let mut best = best_by_trying_all(weights, row + 1, taken);
        for (column, weight) in line.iter().enumerate() {
            if let (Some(weight), false) = (weight, taken[column]) {
                taken[column] = true;
                best = best.max(weight + best_by_trying_all(weights, row + 1, taken));
                taken[column] = false;
            }
        }
        best
    }

    /// The same to the letter: each row's own column beside the others, over the whole.
    fn to_the_letter(rows: usize, columns: usize, weights: &Weights) -> Vec<(usize, usize)> {
        let cost = |row: usize, column: usize| match weights[row].get(column) {
            Some(weight) => weight.map_or(f64::INFINITY, |weight| -weight),
            None if column - columns == row => 0.0,
            None => f64::INFINITY,
        };
        let width = columns + rows;
        let (mut row_potential, mut column_potential) = (vec![0.0; rows], vec![0.0; width]);
        let mut row_of: Vec<Option<usize>> = vec![None; width];
        for start in 0..rows {
            let mut slack = vec![f64::INFINITY; width];
            let mut from: Vec<Option<usize>> = vec![None; width];
            let mut done = vec![false; width];
            let (mut row, mut last) = (start, None);
            let mut column = loop {
                for column in (0..width).filter(|column| !done[*column]) {
                    let reduced = cost(row, column) - row_potential[row] - column_potential[column];
                    if reduced < slack[column] {
                        (slack[column], from[column]) = (reduced, last);
                    }
                }
                let open = (0..width).filter(|column| !done[*column]);
                let nearest = open.min_by(|a, b| slack[*a].total_cmp(&slack[*b])).unwrap();
                let step = slack[nearest];
                row_potential[start] += step;
                for column in 0..width {
                    if done[column] {
                        column_potential[column] -= step;
                        row_potential[row_of[column].unwrap()] += step;
                    } else {
                        slack[column] -= step;
                    }
                }
                done[nearest] = true;
                match row_of[nearest] {
                    None => break nearest,
                    Some(next) => (row, last) = (next, Some(nearest)),
                }
            };
            while let Some(before) = from[column] {
                row_of[column] = row_of[before];
                column = before;
            }
            row_of[column] = Some(start);
        }
        let mut pairs: Vec<_> = (0..columns).filter_map(|column| Some((row_of[column]?, column))).collect();
        pairs.sort_unstable();
        pairs
    }

    fn any_weights() -> impl Strategy<Value = Weights> {
        (0usize..7, 0usize..7).prop_flat_map(|(rows, columns)| {
            // Few of many are possible, as between two maps; of few weights, many tie.
            let weight = (1u32..6).prop_map(|w| f64::from(w) / 4.0);
            let weight = prop_oneof![2 => Just(None), 1 => weight.prop_map(Some)];
            prop::collection::vec(prop::collection::vec(weight, columns), rows)
        })
    }

    proptest! {
        #[test]
        fn no_other_assignment_weighs_more(weights in any_weights()) {
            let columns = weights.first().map_or(0, Vec::len);
            let pairs = assign(&edges(weights.len(), columns, |row, column| weights[row][column]));
            let mut rows_seen = std::collections::BTreeSet::new();
            let mut columns_seen = std::collections::BTreeSet::new();
            let mut sum = 0.0;
            for (row, column) in pairs {
                prop_assert!(rows_seen.insert(row) && columns_seen.insert(column));
                sum += weights[row][column].expect("only possible pairs are taken");
            }
            prop_assert_eq!(sum, best_by_trying_all(&weights, 0, &mut vec![false; columns]));
        }

        #[test]
        fn components_are_assigned_as_the_whole_is_to_the_letter_in_ties_too(weights in any_weights()) {
            let columns = weights.first().map_or(0, Vec::len);
            let whole = to_the_letter(weights.len(), columns, &weights);
            prop_assert_eq!(assign(&edges(weights.len(), columns, |row, column| weights[row][column])), whole);
        }
    }
}
