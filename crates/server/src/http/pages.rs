//! Pages: the viewer and the API reference, embedded in the binary. They load nothing from other servers.

use std::future::ready;

use axum::Router;
use axum::body::Bytes;
use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::IntoResponse;
use axum::routing::get;

use crate::api::words;

/// No external content, no inline script, and no framing by other sites.
const POLICY: &str = "default-src 'self'; img-src 'self' data: blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'self'";

struct Asset {
    name: &'static str,
    bytes: &'static [u8],
}

macro_rules! assets {
    ($($name:literal)*) => {
        &[$(Asset {
            name: $name,
            bytes: include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/", $name)),
        }),*]
    };
}

/// Every file of `assets/`; a test reports missing ones.
#[rustfmt::skip]
const ASSETS: &[Asset] = assets![
    "docs.css"
    "docs.html"
    "docs.js"
    "docs_problems.js"
    "docs_prose.js"
    "docs_run.js"
    "docs_schema.js"
    "docs_start.js"
    "docs_try.js"
    "dom.js"
    "favicon.svg"
    "page.css"
    "viewer.css"
    "viewer.html"
    "viewer.js"
    "viewer_address.js"
    "viewer_anchor_words.js"
    "viewer_api.js"
    "viewer_asked.js"
    "viewer_cameras.js"
    "viewer_canvas.js"
    "viewer_changes.js"
    "viewer_colours.js"
    "viewer_compare.css"
    "viewer_compare.js"
    "viewer_confirm.js"
    "viewer_crop.js"
    "viewer_details.js"
    "viewer_draw.js"
    "viewer_empty.js"
    "viewer_event_list.js"
    "viewer_events.js"
    "viewer_evidence.js"
    "viewer_follow.js"
    "viewer_gauges.js"
    "viewer_header.js"
    "viewer_keys.js"
    "viewer_labels.js"
    "viewer_legend.js"
    "viewer_lists.js"
    "viewer_loops.js"
    "viewer_marks.js"
    "viewer_pairs.js"
    "viewer_picture.js"
    "viewer_place.js"
    "viewer_plans.js"
    "viewer_reader.js"
    "viewer_releases.css"
    "viewer_releases.js"
    "viewer_scene.js"
    "viewer_steps.js"
    "viewer_sweep.js"
    "viewer_tables.js"
    "viewer_tabs.js"
    "viewer_time.js"
    "viewer_tip.js"
    "viewer_trajectory.js"
    "viewer_turns.js"
    "viewer_until.js"
    "viewer_verdict.js"
    "viewer_verdicts.js"
    "viewer_views.js"
    "viewer_where.js"
    "viewer_why_not.js"
];

/// The codes of verdicts with their texts, generated from the tables of the model.
const WORDS: &str = "words.js";

/// Returns their routes: pages under their own addresses, all other files under `/assets`.
pub fn routes<S: Clone + Send + Sync + 'static>() -> Router<S> {
    let words = Bytes::from(words::script());
    let words = move || ready(serve(WORDS, words.clone()));
    let router = Router::new().route(&format!("/assets/{WORDS}"), get(words));
    ASSETS.iter().fold(router, |router, asset| {
        let path = match asset.name {
            "viewer.html" => "/".to_owned(),
            "docs.html" => "/docs".to_owned(),
            name => format!("/assets/{name}"),
        };
        router.route(&path, get(move || ready(serve(asset.name, asset.bytes))))
    })
}

fn serve(name: &str, content: impl IntoResponse) -> impl IntoResponse {
    let headers = [
        (CONTENT_TYPE, media_type(name)),
        (CONTENT_SECURITY_POLICY, POLICY),
        // A new binary has new files under the same addresses.
        (CACHE_CONTROL, "no-cache"),
    ];
    (headers, content)
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_assets_is_served_as_what_it_is() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/assets");
        let files =
            std::fs::read_dir(folder).expect("a folder").map(|file| file.expect("a file").file_name());
        let mut present: Vec<String> = files.map(|name| name.to_string_lossy().into_owned()).collect();
        let mut embedded: Vec<&str> = ASSETS.iter().map(|asset| asset.name).collect();
        present.sort_unstable();
        embedded.sort_unstable();
        assert_eq!(embedded, present, "list the files of assets/ in ASSETS");
        assert!(embedded.iter().all(|name| media_type(name) != "application/octet-stream"), "{embedded:?}");
    }
}
