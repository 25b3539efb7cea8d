//! Pages: the viewer and the reference, embedded in the binary; they load nothing from anywhere else.

use axum::Router;
use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, X_CONTENT_TYPE_OPTIONS};
use axum::response::IntoResponse;
use axum::routing::get;

/// Nothing from elsewhere, no inline script, and no framing by others.
const POLICY: &str = "default-src 'self'; img-src 'self' data: blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'self'";

struct Page {
    path: &'static str,
    media_type: &'static str,
    bytes: &'static [u8],
}

macro_rules! page {
    ($path:literal, $file:literal, $media_type:expr) => {
        Page {
            path: $path,
            media_type: $media_type,
            bytes: include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/", $file)),
        }
    };
}

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";

const PAGES: [Page; 5] = [
    page!("/", "viewer.html", HTML),
    page!("/docs", "docs.html", HTML),
    page!("/assets/viewer.js", "viewer.js", SCRIPT),
    page!("/assets/docs.js", "docs.js", SCRIPT),
    page!("/assets/revisit.css", "revisit.css", STYLE),
];

/// Their routes.
pub fn routes<S: Clone + Send + Sync + 'static>() -> Router<S> {
    PAGES.iter().fold(Router::new(), |router, page| router.route(page.path, get(move || serve(page))))
}

async fn serve(page: &'static Page) -> impl IntoResponse {
    let headers = [
        (CONTENT_TYPE, page.media_type),
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        // The binary changes under the same addresses.
        (CACHE_CONTROL, "no-cache"),
    ];
    (headers, page.bytes)
}
