//! Assignment by maximum weight: each row takes at most one column, each column at most one row.

/// Pairs `(row, column)` that maximise the sum of weights, ascending by row. `weight` gives the
/// weight of a possible pair, positive and finite, or `None`. Hungarian method with potentials
/// (Kuhn 1955, in the O(n^2 m) form of Jonker and Volgenant), deterministic in ties.
pub fn assign(
    rows: usize,
    columns: usize,
    weight: impl Fn(usize, usize) -> Option<f64>,
) -> Vec<(usize, usize)> {
    if rows == 0 || columns == 0 {
        return Vec::new();
    }
    // A row may stay alone: each has a column of its own at weight zero behind the real ones.
    let cost = |row: usize, column: usize| -> f64 {
        if column < columns {
            weight(row, column).map_or(f64::INFINITY, |w| -w)
        } else if column - columns == row {
            0.0
        } else {
            f64::INFINITY
        }
    };
    let width = columns + rows;
    let mut row_potential = vec![0.0; rows];
    let mut column_potential = vec![0.0; width];
    let mut row_of: Vec<Option<usize>> = vec![None; width];
    for start in 0..rows {
        // Shortest augmenting path from `start` (Dijkstra over reduced costs).
        let mut slack = vec![f64::INFINITY; width];
        let mut from: Vec<Option<usize>> = vec![None; width];
        let mut done = vec![false; width];
        let (mut row, mut last) = (start, None);
        // Each row's potential at the first step makes all its reduced costs finite and comparable.
        let end = loop {
            for column in 0..width {
                let reduced = cost(row, column) - row_potential[row] - column_potential[column];
                if !done[column] && reduced < slack[column] {
                    slack[column] = reduced;
                    from[column] = last;
                }
            }
            let nearest =
                (0..width).filter(|column| !done[*column]).min_by(|a, b| slack[*a].total_cmp(&slack[*b]));
            let Some(nearest) = nearest else { return pairs(&row_of, columns) };
            let step = slack[nearest];
            row_potential[start] += step;
            for column in 0..width {
                if done[column] {
                    column_potential[column] -= step;
                    if let Some(row) = row_of[column] {
                        row_potential[row] += step;
                    }
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
        // Turn the path around.
        let mut column = end;
        loop {
            let Some(before) = from[column] else {
                row_of[column] = Some(start);
                break;
            };
            row_of[column] = row_of[before];
            column = before;
        }
    }
    pairs(&row_of, columns)
}

fn pairs(row_of: &[Option<usize>], columns: usize) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> =
        row_of.iter().take(columns).enumerate().filter_map(|(column, row)| Some(((*row)?, column))).collect();
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

    fn any_weights() -> impl Strategy<Value = Weights> {
        (0usize..6, 0usize..6).prop_flat_map(|(rows, columns)| {
            let weight = prop::option::of((1u32..20).prop_map(|w| f64::from(w) / 4.0));
            prop::collection::vec(prop::collection::vec(weight, columns), rows)
        })
    }

    proptest! {
        #[test]
        fn no_other_assignment_weighs_more(weights in any_weights()) {
            let columns = weights.first().map_or(0, Vec::len);
            let pairs = assign(weights.len(), columns, |row, column| weights[row][column]);
            let mut rows_seen = std::collections::BTreeSet::new();
            let mut columns_seen = std::collections::BTreeSet::new();
            let mut sum = 0.0;
            for (row, column) in pairs {
                prop_assert!(rows_seen.insert(row) && columns_seen.insert(column));
                sum += weights[row][column].expect("only possible pairs are taken");
            }
            prop_assert_eq!(sum, best_by_trying_all(&weights, 0, &mut vec![false; columns]));
        }
    }
}
