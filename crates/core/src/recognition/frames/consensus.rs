//! Consensus between two sessions: the largest set of their loops of which each agrees with each.

use super::measurement::Measurement;

/// Loops between two sessions that are compared each with each; of more, some spread over all.
pub const COMPARED_MAX: usize = 256;

/// Sets that are begun, each with another of the loops that agree with most.
const BEGUN_MAX: usize = 16;

/// The loops between two sessions that agree, and those that do not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Consensus {
    /// The numbers of those in the largest agreeing set, ascending.
    pub agreeing: Vec<usize>,
    /// Of them the one that is least off from the others.
    pub middle: usize,
    /// Whether another set that shares none of them is as large: nobody can tell which of the two is right.
    pub is_tie: bool,
}

/// Finds the largest agreeing set among measurements of the same two sessions, by their numbers in `all`. Finding the very largest is
/// hard in general (it is a clique); this begins with each of the loops that agree with most, and adds those that agree with
/// all so far, the most agreeing first.
pub fn consensus(all: &[Measurement], numbers: &[usize]) -> Option<Consensus> {
    let step = numbers.len().div_ceil(COMPARED_MAX).max(1);
    let compared: Vec<usize> = numbers.iter().copied().step_by(step).collect();
    let count = compared.len();
    let mut agrees = vec![vec![false; count]; count];
    for i in 0..count {
        for j in 0..i {
            let both = all[compared[i]].agrees(&all[compared[j]]);
            (agrees[i][j], agrees[j][i]) = (both, both);
        }
    }
    let degree: Vec<usize> = agrees.iter().map(|row| row.iter().filter(|is| **is).count()).collect();
    let mut by_degree: Vec<usize> = (0..count).collect();
    by_degree.sort_by_key(|i| (std::cmp::Reverse(degree[*i]), *i));
    let sets: Vec<Vec<usize>> =
        by_degree.iter().take(BEGUN_MAX).map(|first| grown(*first, &by_degree, &agrees)).collect();
    // The first of the largest, which begins with the loop that agrees with most, the oldest of equals.
    let best = sets.iter().rev().max_by_key(|set| set.len())?;
    let is_other = |set: &Vec<usize>| set.len() == best.len() && set.iter().all(|i| !best.contains(i));
    let is_tie = sets.iter().any(is_other);
    let mut agreeing: Vec<usize> = best.iter().map(|i| compared[*i]).collect();
    let known: Vec<usize> = agreeing.clone();
    let others = numbers.iter().filter(|number| !compared.contains(number));
    agreeing.extend(others.filter(|number| known.iter().all(|one| all[**number].agrees(&all[*one]))));
    agreeing.sort_unstable();
    let middle = middle(all, &agreeing)?;
    Some(Consensus { agreeing, middle, is_tie })
}

/// Returns the set that begins with one and takes in whatever agrees with all of it.
fn grown(first: usize, by_degree: &[usize], agrees: &[Vec<bool>]) -> Vec<usize> {
    let mut set = vec![first];
    for next in by_degree {
        if *next != first && set.iter().all(|one| agrees[*one][*next]) {
            set.push(*next);
        }
    }
    set.sort_unstable();
    set
}

/// Returns the one that is least off from the others, the first of equals.
fn middle(all: &[Measurement], agreeing: &[usize]) -> Option<usize> {
    let off = |one: &usize| -> f64 {
        let others = agreeing.iter().take(COMPARED_MAX);
        others.map(|other| all[*other].off(&all[*one].a_from_b).0).sum()
    };
    let offs = agreeing.iter().take(COMPARED_MAX).map(|one| (*one, off(one)));
    offs.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0))).map(|(one, _)| one)
}
