//! Curve: precision over recall by query, as the threshold of an arm's ranking score varies from strict to lenient.

use super::score::by_query;
use crate::hotel::figures::Curve;
use crate::hotel::run::RunResult;

/// Returns the curve of an arm over several runs, from the server's answers. A robot that waits for more keyframes to
/// agree works at another point, the operating point. Queries whose first candidate is neither correct nor wrong are
/// omitted.
pub fn curve(drives: &[&RunResult]) -> Option<Curve> {
    let arm = drives.first()?.arm;
    let asked = || drives.iter().flat_map(|driven| &driven.asked);
    let mut ranked: Vec<(f64, bool)> =
        asked().filter_map(|asked| asked.ranked).map(|ranked| (ranked.score, ranked.is_right)).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let with_truth = asked().filter(|asked| asked.scored.has_truth).count() as f64;
    let (mut right, mut points) = (0_u32, Vec::new());
    for (number, (score, is_right)) in ranked.iter().enumerate() {
        right += u32::from(*is_right);
        // Equal scores are accepted together, and a score of zero accepts nothing.
        let is_last_of_equals = ranked.get(number + 1).is_none_or(|next| next.0 < *score);
        if is_last_of_equals && *score > 0.0 {
            points.push((f64::from(right) / with_truth, f64::from(right) / (number + 1) as f64));
        }
    }
    let counts = by_query(&asked().map(|asked| asked.scored).collect::<Vec<_>>());
    Some(Curve {
        name: if arm.confirms() {
            format!("{}, before confirmation", arm.title())
        } else {
            arm.title().to_owned()
        },
        points,
        operating_point: Some((counts.recall(), counts.precision())),
    })
}
