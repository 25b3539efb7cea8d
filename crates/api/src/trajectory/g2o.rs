//! g2o: a pose graph (Kümmerle et al., "g2o: a general framework for graph optimization", ICRA 2011), as gtsam reads it too.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use nalgebra::{Matrix6, UnitQuaternion, Vector6};
use revisit_core::domain::change::Loop;
use revisit_core::domain::ids::KeyframeId;
use revisit_core::domain::trajectory::{TrackedPose, TrajectoryReport};
use revisit_core::geometry::Pose;

use super::measured::MeasuredLoop;

/// Standard deviations of an edge between neighbours of a session: the larger of a length and a share of the way, and an angle.
/// The map keeps no covariance of a robot's own tracking, so these are a guess.
const NEIGHBOUR_SIGMA_M: f64 = 0.01;
const NEIGHBOUR_SIGMA_SHARE: f64 = 0.02;
const NEIGHBOUR_SIGMA_RAD: f64 = 0.01;

/// Writes the graph: a vertex for each keyframe, an edge between neighbours of a session, and one for each loop whose
/// transformation is known. Information is in metres and radians, in the frame of the edge's second vertex.
///
/// Sessions have frames of their own, which only loops join; the first keyframe is held fixed.
pub fn g2o(report: &TrajectoryReport, measured: &[Option<MeasuredLoop>]) -> String {
    let mut graph = Graph::default();
    let _ = writeln!(graph.text, "# map version {}; poses are map_from_camera", report.map_version);
    for track in &report.sessions {
        let _ = writeln!(graph.text, "# session {}", track.session);
        track.keyframes.iter().for_each(|at| graph.vertex(at));
    }
    for track in &report.sessions {
        for pair in track.keyframes.windows(2) {
            graph.neighbours(&pair[0], &pair[1]);
        }
    }
    for (closed, measured) in report.loops.iter().zip(measured) {
        graph.closed(closed, measured.as_ref());
    }
    graph.text
}

#[derive(Default)]
struct Graph {
    text: String,
    numbers: BTreeMap<KeyframeId, usize>,
}

impl Graph {
    fn vertex(&mut self, at: &TrackedPose) {
        let number = self.numbers.len();
        self.numbers.insert(at.keyframe.clone(), number);
        let _ = writeln!(self.text, "# {number} is {}", at.keyframe);
        let _ = writeln!(self.text, "VERTEX_SE3:QUAT {number} {}", numbers(&at.map_from_camera));
        if number == 0 {
            self.text.push_str("FIX 0\n");
        }
    }

    fn neighbours(&mut self, one: &TrackedPose, next: &TrackedPose) {
        let between = one.map_from_camera.inverse().after(&next.map_from_camera);
        let way_m = between.isometry().translation.vector.norm();
        let (of_m, of_rad) =
            (NEIGHBOUR_SIGMA_M.max(NEIGHBOUR_SIGMA_SHARE * way_m).powi(-2), NEIGHBOUR_SIGMA_RAD.powi(-2));
        let information = Matrix6::from_diagonal(&Vector6::new(of_m, of_m, of_m, of_rad, of_rad, of_rad));
        self.edge(&one.keyframe, &next.keyframe, &between, &information);
    }

    fn closed(&mut self, closed: &Loop, measured: Option<&MeasuredLoop>) {
        let Loop { id, keyframe_id: keyframe, candidate_id: candidate, .. } = closed;
        let information =
            measured.and_then(|it| information(it.covariance.as_ref()?, &it.candidate_from_query));
        let (Some(measured), Some(information)) = (measured, information) else {
            let _ = writeln!(
                self.text,
                "# loop {id} from {candidate} to {keyframe}: no transformation is kept of it"
            );
            return;
        };
        let _ = writeln!(self.text, "# loop {id}, scale {}", measured.scale);
        self.edge(candidate, keyframe, &measured.candidate_from_query, &information);
    }

    fn edge(&mut self, from: &KeyframeId, to: &KeyframeId, from_to: &Pose, information: &Matrix6<f64>) {
        let (Some(from), Some(to)) = (self.numbers.get(from), self.numbers.get(to)) else { return };
        let _ = write!(self.text, "EDGE_SE3:QUAT {from} {to} {}", numbers(from_to));
        for row in 0..6 {
            for column in row..6 {
                let _ = write!(self.text, " {}", information[(row, column)]);
            }
        }
        self.text.push('\n');
    }
}

fn numbers(pose: &Pose) -> String {
    let ([x, y, z], [qx, qy, qz, qw]) = (pose.translation_m(), pose.rotation_xyzw());
    format!("{x} {y} {z} {qx} {qy} {qz} {qw}")
}

/// Returns the inverse of a covariance of `from_to`, whose axes are the first frame's, about the axes of the second;
/// none where it is no covariance.
fn information(covariance: &[f64; 36], from_to: &Pose) -> Option<Matrix6<f64>> {
    let covariance = Matrix6::from_row_slice(covariance);
    let to_from: UnitQuaternion<f64> = from_to.isometry().rotation.inverse();
    let turn = to_from.to_rotation_matrix();
    let mut turns = Matrix6::zeros();
    turns.fixed_view_mut::<3, 3>(0, 0).copy_from(turn.matrix());
    turns.fixed_view_mut::<3, 3>(3, 3).copy_from(turn.matrix());
    let information = (turns * covariance * turns.transpose()).cholesky()?.inverse();
    // The same number on both sides of the diagonal, to the bit.
    let information = (information + information.transpose()) * 0.5;
    information.iter().all(|number| number.is_finite()).then_some(information)
}
