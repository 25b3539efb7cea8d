//! What verifying one candidate costs: keyframes of 1,000 features, beside what peers were measured to take.
//!
//! `cargo bench --bench verification`. Places are drawn from a seed: half the query's features show points of the
//! candidate, with noise in pixels, positions and descriptors; the rest show something else.

use std::hint::black_box;
use std::time::{Duration, Instant};

use nalgebra::{UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use revisit::domain::keyframe::{Camera, Keypoint};
use revisit::domain::verdict::GeometryStatus;
use revisit::geometry::hamming::{Columns, PackedDescriptors, distance};
use revisit::geometry::pinhole::Pinhole;
use revisit::geometry::{Point3, Sim3};
use revisit::recognition::verification::correspondence::{Cameras, Correspondence, Reprojection};
use revisit::recognition::verification::descriptor_matching::{Side, match_descriptors};
use revisit::recognition::verification::ransac::sample_consensus;
use revisit::recognition::verification::refinement::refine;
use revisit::recognition::verification::{Landmark, Limits, View, verify};

const FEATURES: usize = 1_000;
const WINDOW: usize = 2_000;
const PAIRS: usize = 100;
const HYPOTHESES: u32 = 300;
const CAMERA: Camera = Camera { fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0, width: 640, height: 480 };
/// The nodes that `SearchByBoW` compares by: level 2 of a vocabulary with ten children a node.
const NODES: u32 = 100;

fn main() {
    println!("{:<44}{:>11}{:>11}{:>18}", "", "median", "p99", "peer, elsewhere");
    hamming();
    matching();
    geometry();
    whole();
}

/// One line of the table; the peer's time, in milliseconds, is of another machine, so that a ratio would mean nothing.
fn row(name: &str, peer_ms: Option<(f64, f64)>, mut run: impl FnMut()) {
    const BUDGET: Duration = Duration::from_millis(800);
    run();
    let mut times = Vec::new();
    let start = Instant::now();
    while start.elapsed() < BUDGET || times.len() < 100 {
        let before = Instant::now();
        run();
        times.push(before.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    let (median, p99) = (times[times.len() / 2], times[times.len() * 99 / 100]);
    let peer = match peer_ms {
        Some((low, high)) if low < high => format!("{low}-{high} ms"),
        Some((ms, _)) => format!("{ms} ms"),
        None => "-".into(),
    };
    println!("{name:<44}{median:>8.3} ms{p99:>8.3} ms{peer:>18}");
}

fn hamming() {
    for bytes in [32, 48, 64] {
        let mut rng = rng(1);
        let mut draw = || {
            let all: Vec<u8> = (0..FEATURES * bytes).map(|_| rng.random()).collect();
            PackedDescriptors::from_bytes(bytes, &all).expect("whole descriptors")
        };
        let (a, b) = (draw(), draw());
        let columns =
            Columns::new(b.words_each(), (0..FEATURES).map(|i| b.get(i)).collect::<Vec<_>>().into_iter());
        let mut distances = Vec::new();
        row(&format!("1,000,000 distances, {bytes} bytes, by columns"), None, || {
            for i in 0..FEATURES {
                columns.distances_to(a.get(i), &mut distances);
                black_box(&distances);
            }
        });
        row(&format!("1,000,000 distances, {bytes} bytes, one by one"), None, || {
            let rows = (0..FEATURES).flat_map(|i| (0..FEATURES).map(move |j| (i, j)));
            black_box(rows.map(|(i, j)| distance(a.get(i), b.get(j))).sum::<u32>());
        });
    }
}

fn matching() {
    let place = Place::new(2, 32);
    let features: Vec<u32> = (0..FEATURES as u32).collect();
    let limits = Limits::DEFAULT.matching;
    for (name, guided, peer) in
        [("matching, guided by nodes", true, Some((0.27, 0.38))), ("matching, exhaustive", false, None)]
    {
        row(name, peer, || {
            let side = |half: &'static str| {
                let keyframe = if half == "query" { &place.query } else { &place.candidate };
                Side {
                    descriptors: &keyframe.descriptors,
                    keypoints: &keyframe.keypoints,
                    nodes: guided.then_some(&keyframe.nodes[..]),
                    features: &features,
                }
            };
            black_box(match_descriptors(&side("query"), &side("candidate"), &limits));
        });
    }
}

fn geometry() {
    let camera = Pinhole { fx: CAMERA.fx, fy: CAMERA.fy, cx: CAMERA.cx, cy: CAMERA.cy };
    let cameras = Cameras { query: camera, candidate: camera };
    let mut limits = Limits::DEFAULT;
    limits.sampling.max_hypotheses = HYPOTHESES;
    limits.sampling.max_chance_of_miss = -1.0;
    for outliers in [0.0, 0.5] {
        let (planted, pairs) = draw_pairs(outliers);
        let mut degenerate = 0;
        let name = format!("RANSAC, 300 hypotheses, 100 pairs, {:.0} % false", outliers * 100.0);
        row(&name, Some((0.95, 0.95)), || {
            degenerate = black_box(sample_consensus(&pairs, &cameras, &limits, 5)).degenerate;
        });
        println!("    of the 300 samples, refused before a test: {degenerate}");
        if outliers == 0.0 {
            let places: Vec<u32> = (0..PAIRS as u32).collect();
            let off = Sim3::new(1.0, [0.1, -0.05, 0.1], [0.02, 0.0, 0.01, 0.999]).expect("a small move");
            for (name, fixed) in
                [("refinement of 100 pairs, scale fixed", true), ("refinement of 100 pairs", false)]
            {
                row(name, Some((3.3, 3.3)), || {
                    black_box(refine(&off.after(&planted), &pairs, &places, &cameras, fixed));
                });
            }
        }
    }
}

fn whole() {
    const PLACES: u64 = 40;
    for (name, guided, share_true) in [
        ("verification of a true candidate, nodes", true, true),
        ("verification of a true candidate, no nodes", false, true),
        ("verification of a false candidate, nodes", true, false),
        ("verification of a false candidate, no nodes", false, false),
    ] {
        let places: Vec<Place> = (0..PLACES).map(|seed| Place::new(seed, 32)).collect();
        let mut next = 0;
        row(name, None, || {
            let place = &places[next % places.len()];
            let other = if share_true { place } else { &places[(next + 1) % places.len()] };
            let window: Vec<Landmark> = other.window();
            let found = verify(
                &place.query.view(guided),
                &other.candidate.view(guided),
                &window,
                &Limits::DEFAULT,
                1,
            );
            assert_eq!(found.status == GeometryStatus::Verified, share_true, "{found:?}");
            next += 1;
        });
    }
}

fn draw_pairs(outliers: f64) -> (Sim3, Vec<Correspondence>) {
    let mut rng = rng(4);
    let planted = query_pose(&mut rng);
    let pairs = (0..PAIRS)
        .map(|i| {
            let in_query = point(&mut rng);
            let in_candidate = if (i as f64) < outliers * PAIRS as f64 {
                point(&mut rng)
            } else {
                planted.transform(&in_query)
            };
            let mut reprojection = |from: &Point3, to: &Point3| Reprojection {
                point: from.coords,
                pixel: pixel(to).map(|at| at + rng.random_range(-1.0..1.0)),
                inverse_variance: Limits::DEFAULT.variance_px2(0).recip(),
                depth: Limits::DEFAULT.depth(to.z),
            };
            Correspondence {
                into_query: Some(reprojection(&in_candidate, &in_query)),
                into_candidate: Some(reprojection(&in_query, &in_candidate)),
                distance: 0,
                query_feature: i as u32,
                candidate_feature: Some(i as u32),
            }
        })
        .collect();
    (planted, pairs)
}

/// A query and a candidate that see one place, and landmarks of the candidate's neighbours.
struct Place {
    query: Keyframe,
    candidate: Keyframe,
    window: Keyframe,
}

struct Keyframe {
    keypoints: Vec<Keypoint>,
    descriptors: PackedDescriptors,
    nodes: Vec<u32>,
    points: Vec<Option<Point3>>,
}

impl Place {
    fn new(seed: u64, bytes: usize) -> Self {
        let mut rng = rng(seed);
        let query_from_candidate = query_pose(&mut rng).inverse();
        let (mut query, mut candidate, mut window) = (Draft::default(), Draft::default(), Draft::default());
        for i in 0..FEATURES + WINDOW {
            let (at, node) = (point(&mut rng), rng.random_range(0..NODES));
            let descriptor: Vec<u8> = (0..bytes).map(|_| rng.random()).collect();
            if i < FEATURES {
                candidate.push(&mut rng, at, &descriptor, node);
                if i % 2 == 0 {
                    query.push(&mut rng, query_from_candidate.transform(&at), &descriptor, node);
                } else {
                    let other: Vec<u8> = (0..bytes).map(|_| rng.random()).collect();
                    let (at, node) = (point(&mut rng), rng.random_range(0..NODES));
                    query.push(&mut rng, at, &other, node);
                }
            } else {
                window.push(&mut rng, at, &descriptor, node);
            }
        }
        Self { query: query.finish(bytes), candidate: candidate.finish(bytes), window: window.finish(bytes) }
    }

    fn window(&self) -> Vec<Landmark<'_>> {
        let landmark = |(i, at): (usize, &Option<Point3>)| {
            Some(Landmark {
                id: i as u64,
                point_in_camera: (*at)?,
                descriptor: self.window.descriptors.get(i),
            })
        };
        self.window.points.iter().enumerate().filter_map(landmark).collect()
    }
}

impl Keyframe {
    fn view(&self, guided: bool) -> View<'_> {
        View {
            camera: CAMERA,
            keypoints: &self.keypoints,
            descriptors: &self.descriptors,
            nodes: guided.then_some(&self.nodes[..]),
            points_in_camera: &self.points,
        }
    }
}

#[derive(Default)]
struct Draft {
    keypoints: Vec<Keypoint>,
    bytes: Vec<u8>,
    nodes: Vec<u32>,
    points: Vec<Option<Point3>>,
}

impl Draft {
    /// A feature as it is seen: a pixel, a centimetre and some bits off; every second one has a position.
    fn push(&mut self, rng: &mut ChaCha8Rng, at: Point3, descriptor: &[u8], node: u32) {
        let [u, v] = pixel(&at).map(|at| at + rng.random_range(-1.0..1.0));
        let octave = rng.random_range(0..8);
        self.keypoints.push(Keypoint { u, v, octave, angle_deg: Some(rng.random_range(0.0..5.0)) });
        let mut descriptor = descriptor.to_vec();
        for _ in 0..descriptor.len() {
            let bit = rng.random_range(0..8 * descriptor.len());
            descriptor[bit / 8] ^= 1 << (bit % 8);
        }
        self.bytes.extend(descriptor);
        self.nodes.push(node);
        let noise = Vector3::from_fn(|_, _| rng.random_range(-0.01..0.01));
        self.points.push(rng.random_bool(0.5).then_some(at + noise));
    }

    fn finish(self, bytes: usize) -> Keyframe {
        let descriptors = PackedDescriptors::from_bytes(bytes, &self.bytes).expect("whole descriptors");
        Keyframe { keypoints: self.keypoints, descriptors, nodes: self.nodes, points: self.points }
    }
}

fn point(rng: &mut ChaCha8Rng) -> Point3 {
    let z = rng.random_range(2.0..8.0);
    Point3::new(rng.random_range(-0.5..0.5) * z, rng.random_range(-0.4..0.4) * z, z)
}

fn pixel(point: &Point3) -> [f64; 2] {
    [CAMERA.fx * point.x / point.z + CAMERA.cx, CAMERA.fy * point.y / point.z + CAMERA.cy]
}

/// `candidate_from_query`.
fn query_pose(rng: &mut ChaCha8Rng) -> Sim3 {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), rng.random_range(-0.2..0.2));
    Sim3::from_parts(1.0, turn, Vector3::from_fn(|_, _| rng.random_range(-0.3..0.3)))
}

fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}
