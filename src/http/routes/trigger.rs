//! The trigger of §III: a keyframe that shows an anchor seen before is asked about, even if nobody asks.

use super::loop_queries::{ask, kept};
use crate::domain::ids::{KeyframeId, MapId};
use crate::domain::request::{LoopQuery, Subject};
use crate::domain::verdict::{Decision, Verify};
use crate::http::App;

/// At most so many triggered checks wait at once. More are passed over: who wants to know asks.
pub const TRIGGERS_AT_ONCE: usize = 64;

/// Asks about the keyframes that models have found to see something seen before, until the server stops.
pub fn ask_about_triggers(app: &App) {
    let Some(mut triggers) = app.service.take_triggers() else { return };
    let app = app.clone();
    tokio::spawn(async move {
        loop {
            tokio::select! {
                () = app.stopping.cancelled() => return,
                next = triggers.recv() => match next {
                    Some((map, keyframe)) => trigger_loop_check(&app, &map, &keyframe),
                    None => return,
                },
            }
        }
    });
}

/// Asks in the background, keeps the verdict, and tells those who listen if it is a loop.
pub fn trigger_loop_check(app: &App, map: &MapId, keyframe: &KeyframeId) {
    // The first that is left out when there is much to do.
    if app.service.pressure().is_high() {
        return;
    }
    let Ok(permit) = app.triggers.clone().try_acquire_owned() else { return };
    let (app, map, keyframe) = (app.clone(), map.clone(), keyframe.clone());
    tokio::spawn(async move {
        let _permit = permit;
        let subject = Subject::Stored(keyframe.clone());
        let query = LoopQuery { subject, verify: Verify::default(), max_wait_ms: 0, seed: 0 };
        // The keyframe or its map may be gone already: then there is nothing to tell.
        let Ok(answer) = ask(&app, &map, query).await else { return };
        if answer.verdict.decision == Decision::Loop && kept(&app, &answer).is_ok() {
            app.service.announce_loop(&keyframe, &answer);
        }
    });
}
