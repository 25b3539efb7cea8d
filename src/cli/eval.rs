//! `revisit eval`: experiments.

use clap::Args;
use futures_util::StreamExt as _;

use super::Failure;
use crate::client::Client;
use crate::hotel::arm::Arm;
use crate::hotel::noise::NoiseKind;
use crate::hotel::paper::SEQUENCES;
use crate::hotel::scenario::Scenario;
use crate::hotel::score::{Counts, Outcome, by_query, by_visit};
use crate::hotel::texture::Patterns;
use crate::hotel::trial::{absolute_pose_error_m, drive, odometry};
use crate::http::RunningServer;
use crate::service::{Service, ServiceOptions};

/// Evaluate.
#[derive(Args, Debug)]
pub struct EvalArgs {
    /// what
    what: String,
    #[arg(long)]
    worlds: Option<u64>,
    #[arg(long, default_value = "none")]
    noise: String,
    #[arg(long)]
    world: Option<u64>,
    #[arg(long, default_value_t = 12)]
    sequences: usize,
    #[arg(long)]
    explain: bool,
    #[arg(long, default_value = "ours,paper,bow")]
    arms: String,
}

/// Runs it.
pub async fn run(args: EvalArgs) -> Result<(), Failure> {
    let patterns = Patterns::new();
    let dir = tempfile::tempdir()?;
    let voc = dir.path().join("hotel.voc");
    patterns.vocabulary()?.write_binary(std::fs::File::create(&voc)?)?;
    let service = Service::open(ServiceOptions {
        database: format!("sqlite://{}", dir.path().join("e.db").display()),
        vocabulary: Some(voc),
    })
    .await?;
    let server = RunningServer::start(service).await?;
    let client = Client::new(&server.url())?;
    let arms: Vec<Arm> =
        Arm::ALL.into_iter().filter(|a| args.arms.split(',').any(|n| n == a.name())).collect();
    let mut jobs: Vec<(String, NoiseKind, u64, Option<usize>)> = Vec::new();
    if let Some(n) = args.worlds {
        let seeds: Vec<u64> = args.world.map_or_else(|| (0..n).collect(), |w| vec![w]);
        for kind in NoiseKind::TROUBLES.into_iter().chain([NoiseKind::None]) {
            if args.noise == "all" && kind != NoiseKind::None || args.noise == kind.name() {
                for seed in &seeds {
                    jobs.push((format!("{}-{seed}", kind.name()), kind, *seed, None));
                }
            }
        }
    } else {
        for (i, s) in SEQUENCES.iter().enumerate().take(args.sequences) {
            jobs.push((s.name().replace(' ', "-"), NoiseKind::None, 0, Some(i)));
        }
    }
    let results = futures_util::stream::iter(jobs).map(|(name, kind, seed, seq)| {
        let (client, patterns, arms) = (client.clone(), patterns.clone(), arms.clone());
        let explain = args.explain;
        async move {
            let t0 = std::time::Instant::now();
            let scenario = tokio::task::spawn_blocking(move || match seq { Some(i) => Scenario::of_paper(&SEQUENCES[i], &patterns), None => Scenario::random(seed, kind, &patterns) }).await.unwrap();
            let made = t0.elapsed();
            let vo = absolute_pose_error_m(&scenario.course.journeys, &odometry(&scenario.course));
            let mut line = format!("{name:12} kf {} gen {:.1}s vo {vo:.3}", scenario.course.order.len(), made.as_secs_f64());
            let mut counts = Vec::new();
            {
                let steps = &scenario.course.journeys[0].steps;
                let mut n: Vec<usize> = steps.iter().map(|s| s.features.len()).collect();
                n.sort_unstable();
                let ids = |s: &crate::hotel::journey::Step| s.map_points.iter().map(|m| m.0).collect::<std::collections::HashSet<_>>();
                let mut sh: Vec<usize> = steps.windows(2).map(|w| ids(&w[0]).intersection(&ids(&w[1])).count()).collect();
                sh.sort_unstable();
                let det: usize = steps.iter().map(|s| s.detections.len()).sum();
                line += &format!(" feat p5 {} p50 {} p95 {} shared p5 {} p50 {} points {} det/kf {:.2}", n[n.len()/20], n[n.len()/2], n[n.len()*19/20], sh[sh.len()/20], sh[sh.len()/2], scenario.world.points.len(), det as f64 / steps.len() as f64);
            }
            for arm in arms {
                let t = std::time::Instant::now();
                let map = format!("{name}-{}", arm.name());
                let driven = drive(&client, &map, arm, &scenario.course, |asked| {
                    if explain && let Some((b, t)) = asked.best.zip(asked.answer.best_transform()) {
                        let stand = |k: (usize, usize)| scenario.course.journeys[k.0].steps[k.1].stop.stand.map_from_camera();
                        let truth = stand(b).inverse().after(&stand(asked.keyframe));
                        let est = crate::hotel::message::pose(t.1).unwrap();
                        let d = truth.inverse().after(&est);
                        println!("{name} ERR {} {:?} -> {:?} {:?} inl {:?} same {} matches {:?} err {:.3} m {:.2} deg far {:.2}", arm.name(), asked.keyframe, b, asked.scored.outcome, asked.answer.leading().and_then(|l| l.inliers()), {
                            let pts = |k: (usize, usize)| scenario.course.journeys[k.0].steps[k.1].features.iter().map(|f| f.point).collect::<std::collections::HashSet<_>>();
                            pts(b).intersection(&pts(asked.keyframe)).count()
                        }, asked.answer.leading().and_then(|l| l.geometry.as_ref().and_then(|g| g.matches)), d.centre().coords.norm(), 2.0 * d.rotation_xyzw()[3].abs().min(1.0).acos().to_degrees(), truth.centre().coords.norm());
                    }
                    if explain && asked.scored.outcome == Outcome::Wrong && let Some(l) = asked.answer.leading() {
                        println!("{name} WHY {} {:?}", arm.name(), l.anchors);
                    }
                    if explain && !matches!(asked.scored.outcome, Outcome::RightlyNone) {
                        let step = &scenario.course.journeys[asked.keyframe.0].steps[asked.keyframe.1];
                        let lead = asked.answer.leading();
                        println!("{name} {} {:?} {:?} visit {:?} {:?} at {:.1?} best {:?} lead {:?} {:?}", arm.name(), asked.keyframe, asked.scored.outcome, asked.scored.visit, step.stop.place, step.stop.stand, asked.best.map(|b| (b, scenario.course.journeys[b.0].steps[b.1].stop.place, scenario.course.journeys[b.0].steps[b.1].stop.stand)),
                            lead.map(|l| (l.keyframe.clone(), l.bow_score(), l.similarity(), l.inliers(), l.reason.clone())), asked.answer.verdict);
                    }
                }).await.unwrap();
                let scored = driven.scored();
                let (q, v) = (by_query(&scored), by_visit(&scored));
                line += &format!(" | {} q {:.3}/{:.3} ({}/{} {}/{}) v {:.2}/{:.2} ape {:.3} c{} {:.1}s", arm.name(), q.precision(), q.recall(), q.right, q.accepted, q.found, q.with_truth, v.precision(), v.recall(), driven.absolute_pose_error_m, driven.closed, t.elapsed().as_secs_f64());
                counts.push((arm, kind, q, v));
                client.delete_map(&map).await.unwrap();
                eprintln!("opt {} ms post {} ms", crate::hotel::robot::OPT.swap(0, std::sync::atomic::Ordering::Relaxed)/1000, crate::hotel::robot::POST.swap(0, std::sync::atomic::Ordering::Relaxed)/1000);
            }
            println!("{line}");
            counts
        }
    }).buffer_unordered(2).collect::<Vec<_>>().await;
    let mut pooled: std::collections::BTreeMap<(NoiseKind, Arm), (Counts, Counts)> =
        std::collections::BTreeMap::new();
    for (arm, kind, q, v) in results.into_iter().flatten() {
        let e = pooled.entry((kind, arm)).or_default();
        e.0 = e.0.plus(q);
        e.1 = e.1.plus(v);
    }
    for ((kind, arm), (q, v)) in pooled {
        println!(
            "{:10} {:6} query P {:.4} R {:.4} ({}/{}, {}/{}) visit P {:.4} R {:.4} ({}/{}, {}/{})",
            kind.name(),
            arm.name(),
            q.precision(),
            q.recall(),
            q.right,
            q.accepted,
            q.found,
            q.with_truth,
            v.precision(),
            v.recall(),
            v.right,
            v.accepted,
            v.found,
            v.with_truth
        );
    }
    server.stop().await?;
    Ok(())
}
