//! Play: turns operations into requests, sequentially in recorded order, and keeps the answers.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::time::Instant;

use indicatif::ProgressBar;
use serde::Serialize;
use serde_json::{Map, Value};

use super::answered::{Answered, Labels};
use super::arguments::ReplayArgs;
use super::frames::Frames;
use super::latency::Times;
use super::recording::{Body, Deleted, Line, Op, Recording};
use crate::cli::failure::Failure;
use crate::client::{Client, ClientError, Recorded};

/// The HTTP status of an existing resource with other content.
const CONFLICT: u16 = 409;

/// Plays one recording.
pub(super) struct Player<'a> {
    client: Client,
    args: &'a ReplayArgs,
    progress: ProgressBar,
    played: Played,
}

/// Numbers of operations that were performed.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Performed {
    /// Keyframes stored.
    pub keyframes: u64,
    pub closed_loops: u64,
    pub pose_corrections: u64,
    /// Changes of what keyframes observe.
    pub observation_changes: u64,
    pub session_merges: u64,
    /// Prior anchors put.
    pub priors: u64,
    /// Anchors described by hand.
    pub descriptions: u64,
    /// Model verdicts imported.
    pub judgements: u64,
    /// Keyframes, anchors and loops removed.
    pub deletions: u64,
}

/// The results of a recording.
#[derive(Debug, Default)]
pub(super) struct Played {
    /// The maps declared, as the server knows them, and whether it had them before.
    pub maps: BTreeMap<String, bool>,
    /// The operations that were performed.
    pub performed: Performed,
    /// Of the keyframes stored, the ones that the server had before.
    pub replayed_keyframes: u64,
    /// Lines that the server rejected.
    pub failed: u64,
    /// Every query that was answered.
    pub queries: Vec<Answered>,
    /// Durations of queries.
    pub query_times: Times,
    /// Durations of keyframe writes.
    pub keyframe_times: Times,
    /// The poses of the sessions' frames, if known.
    pub frames: Frames,
}

impl<'a> Player<'a> {
    pub fn new(client: Client, args: &'a ReplayArgs, progress: ProgressBar, frames: Frames) -> Self {
        Self { client, args, progress, played: Played { frames, ..Played::default() } }
    }

    /// Plays every line, up to the first that fails.
    pub async fn play(mut self, recording: Recording) -> Result<Played, Failure> {
        for line in recording {
            let Line { number, map, op } = line?;
            let map = format!("{}{map}", self.args.map_prefix);
            let what = describe(&map, &op);
            // Without its map no later line can succeed.
            let keep_going = self.args.keep_going && !matches!(op, Op::Map { .. });
            match self.step(&map, op).await {
                Ok(()) => {}
                Err(source) if keep_going && source.problem().is_some() => {
                    self.played.failed += 1;
                    self.say(&format!("line {number}, {what}: {source}"));
                }
                Err(source) if self.is_of_another_replay(&map, &source) => {
                    let server = self.client.base_url();
                    return Err(format!(
                        "line {number}: {server} already has a map {map:?} with other content; replay beside it with \
                         --map-prefix (such as --map-prefix again-), or delete it first\n{source}"
                    )
                    .into());
                }
                Err(source) => return Err(format!("line {number}, {what}: {source}").into()),
            }
            let (keyframes, queries) = (self.played.performed.keyframes, self.played.queries.len());
            self.progress.set_message(format!("{map}: {keyframes} keyframes, {queries} queries"));
        }
        Ok(self.played)
    }

    async fn step(&mut self, map: &str, op: Op) -> Result<(), ClientError> {
        match op {
            Op::Map { body, .. } => self.map(map, body).await?,
            Op::Keyframe { id, body } => self.keyframe(map, &id, body).await?,
            Op::Query { keyframe, body, truth, ignore } => {
                let labels = truth.map(|truth| Labels { truth, ignore });
                self.query(map, keyframe, body, labels).await?;
            }
            Op::Loop { body } => {
                self.client.post_loop(map, &Recorded(body)).await?;
                self.played.performed.closed_loops += 1;
            }
            Op::Poses { body } => {
                self.client.post_poses(map, &Recorded(body)).await?;
                self.played.performed.pose_corrections += 1;
            }
            Op::Observations { body } => {
                self.client.post_observations(map, &Recorded(body)).await?;
                self.played.performed.observation_changes += 1;
            }
            Op::MergeSessions { session, body } => {
                self.client.merge_sessions(map, &session, &Recorded(body)).await?;
                self.played.performed.session_merges += 1;
            }
            Op::Anchor { id, body } => {
                self.client.put_prior_anchor(map, &id, &Recorded(body)).await?;
                self.played.performed.priors += 1;
            }
            Op::Description { keyframe, detection, body } => {
                let anchor = self.client.anchor_of(map, &keyframe, detection).await?;
                self.client.patch_anchor(map, &anchor, &Recorded(body)).await?;
                self.played.performed.descriptions += 1;
            }
            Op::Judgement { body } => {
                self.client.post_model_verdict(map, &Recorded(body)).await?;
                self.played.performed.judgements += 1;
            }
            Op::Delete(deleted) => {
                self.delete(map, deleted).await?;
                self.played.performed.deletions += 1;
            }
        }
        Ok(())
    }

    /// Declares a map; a later line with another body updates the members that it names.
    async fn map(&mut self, map: &str, mut body: Body) -> Result<(), ClientError> {
        self.args.overrides.apply(&mut body);
        let body = Recorded(body);
        if self.played.maps.contains_key(map) {
            return self.client.patch_map(map, &body).await.map(drop);
        }
        let answer = self.client.put_map(map, &body).await?;
        self.played.maps.insert(map.to_owned(), answer.replayed);
        Ok(())
    }

    async fn delete(&self, map: &str, deleted: Deleted) -> Result<(), ClientError> {
        match deleted {
            Deleted::Keyframe(keyframe) => self.client.delete_keyframe(map, &keyframe).await.map(drop),
            Deleted::Anchor { keyframe, detection } => {
                let anchor = self.client.anchor_of(map, &keyframe, detection).await?;
                self.client.delete_anchor(map, &anchor).await.map(drop)
            }
            Deleted::Prior(prior) => self.client.delete_anchor(map, &prior).await.map(drop),
            Deleted::Merge(session) => self.client.revoke_merge(map, &session).await.map(drop),
            Deleted::Loop(closed) => self.client.delete_loop(map, &closed).await.map(drop),
        }
    }

    async fn keyframe(&mut self, map: &str, id: &str, mut body: Body) -> Result<(), ClientError> {
        self.args.overrides.apply_to_keyframe(&mut body);
        self.played.frames.saw(map, id, &body);
        let body = Recorded(body);
        let start = Instant::now();
        let answer = self.client.put_keyframe(map, id, &body, false).await?;
        self.played.keyframe_times.add(start.elapsed());
        self.played.performed.keyframes += 1;
        if answer.replayed {
            if self.played.replayed_keyframes == 0 {
                self.say(&format!(
                    "{id} is in {map} already: queries may find keyframes recorded later; \
                     --map-prefix replays into a new map"
                ));
            }
            self.played.replayed_keyframes += 1;
        }
        Ok(())
    }

    async fn query(
        &mut self,
        map: &str,
        keyframe: String,
        mut body: Map<String, Value>,
        labels: Option<Labels>,
    ) -> Result<(), ClientError> {
        body.insert("keyframe".to_owned(), Value::String(keyframe.clone()));
        if let Some(wait) = self.args.max_wait_ms {
            body.insert("max_wait_ms".to_owned(), wait.into());
        }
        let body = Recorded(body);
        let start = Instant::now();
        let answer = self.client.loop_query(map, &body).await?;
        self.played.query_times.add(start.elapsed());
        let answered = Answered::new(map, &keyframe, labels, &answer);
        if let (true, Some((best, transform))) = (answered.is_right(), answer.best_transform()) {
            self.played.frames.found(map, &keyframe, best, transform);
        }
        self.played.queries.push(answered);
        Ok(())
    }

    /// Whether the conflict is with earlier content of the server; otherwise the recording contradicts itself.
    fn is_of_another_replay(&self, map: &str, error: &ClientError) -> bool {
        let is_conflict = error.problem().is_some_and(|problem| problem.status == CONFLICT);
        is_conflict && self.played.maps.get(map) != Some(&false)
    }

    /// Prints a message on standard error, never on standard output.
    fn say(&self, text: &str) {
        self.progress.suspend(|| {
            // A closed standard error is ignored.
            let _ = writeln!(std::io::stderr(), "{text}");
        });
    }
}

fn describe(map: &str, op: &Op) -> String {
    match op {
        Op::Map { .. } => format!("map {map}"),
        Op::Keyframe { id, .. } => format!("keyframe {id} of {map}"),
        Op::Query { keyframe, .. } => format!("query about {keyframe} of {map}"),
        Op::Loop { .. } => format!("loop in {map}"),
        Op::Poses { .. } => format!("poses of {map}"),
        Op::Observations { .. } => format!("observations of {map}"),
        Op::MergeSessions { session, .. } => format!("merge of session {session} of {map}"),
        Op::Anchor { id, .. } => format!("prior anchor {id} of {map}"),
        Op::Description { keyframe, detection, .. } => {
            format!("description of detection {detection} of {keyframe} of {map}")
        }
        Op::Judgement { .. } => format!("model verdict of {map}"),
        Op::Delete(deleted) => match deleted {
            Deleted::Keyframe(keyframe) => format!("removal of {keyframe} of {map}"),
            Deleted::Anchor { keyframe, detection } => {
                format!("removal of the anchor of detection {detection} of {keyframe} of {map}")
            }
            Deleted::Prior(prior) => format!("removal of prior anchor {prior} of {map}"),
            Deleted::Merge(session) => format!("revocation of the merge of session {session} of {map}"),
            Deleted::Loop(closed) => format!("revocation of loop {closed} of {map}"),
        },
    }
}
