//! The paper's printed figures: Tables II and III.

/// One sequence of §VI-A, as Table III prints it: absolute pose errors in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrintedSequence {
    /// `"SE1"` or `"SE2"`.
    pub dataset: &'static str,
    /// 0 to 5.
    pub number: usize,
    /// The paper's method.
    pub ours_m: f64,
    /// ORB-SLAM3 with its false loops.
    pub orb_slam3_m: f64,
    /// ORB-SLAM3 with loop closing off.
    pub orb_vo_m: f64,
}

/// Table II: ORB-SLAM3's precision on a dataset; its recall is 1, as are both of the paper's method.
pub const ORB_SLAM3_PRECISION: [(&str, f64); 2] = [("SE1", 0.167), ("SE2", 0.194)];

/// Table III.
pub const SEQUENCES: [PrintedSequence; 12] = [
    printed("SE1", 0, 0.081, 11.499, 0.220),
    printed("SE1", 1, 0.189, 13.498, 0.633),
    printed("SE1", 2, 0.083, 13.539, 0.223),
    printed("SE1", 3, 0.163, 12.645, 0.371),
    printed("SE1", 4, 0.179, 12.452, 0.340),
    printed("SE1", 5, 0.109, 12.770, 0.671),
    printed("SE2", 0, 0.146, 7.205, 0.870),
    printed("SE2", 1, 0.160, 9.851, 0.662),
    printed("SE2", 2, 0.240, 10.298, 0.633),
    printed("SE2", 3, 0.448, 12.792, 0.961),
    printed("SE2", 4, 0.112, 7.825, 0.501),
    printed("SE2", 5, 0.141, 9.676, 0.361),
];

/// The sequence of Figure 6.
pub const FIGURE_6: PrintedSequence = SEQUENCES[6];

const fn printed(
    dataset: &'static str,
    number: usize,
    ours_m: f64,
    orb_slam3_m: f64,
    orb_vo_m: f64,
) -> PrintedSequence {
    PrintedSequence { dataset, number, ours_m, orb_slam3_m, orb_vo_m }
}

impl PrintedSequence {
    /// `SE2 00`.
    pub fn name(&self) -> String {
        format!("{} {:02}", self.dataset, self.number)
    }
}
