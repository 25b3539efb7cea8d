//! Errors of bodies that are too large, incomplete or too slow.

use std::error::Error;
use std::io;

use http_body_util::LengthLimitError;

use crate::api::decoding::syntax::TooMany;
use crate::api::limits;
use crate::http::connection::min_rate_body::TooSlow;
use crate::http::problem::{Kind, Problem};

/// Returns the error of a body above the limit.
pub(super) fn too_large() -> Problem {
    Problem::new(
        Kind::TOO_LARGE,
        format!("a body has at most {} bytes, compressed or not", limits::BODY_BYTES),
    )
}

/// Returns the error of a compressed body that expands too much.
pub(super) fn too_dense() -> Problem {
    let (free, fold) = (limits::INFLATED_FREE_BYTES, limits::INFLATED_FOLD);
    let detail = format!(
        "a compressed body may expand to {free} bytes and {fold} times its size, as text and values; this one exceeds that: \
         send it uncompressed, or in parts"
    );
    Problem::new(Kind::TOO_LARGE, detail)
}

/// Returns the error of a body with too many values.
pub(super) fn too_many(what: TooMany) -> Problem {
    let detail = match what {
        TooMany::Values => format!("the body has more than {} values", limits::BODY_VALUES),
        TooMany::Items => format!("a list of the body has more than {} items", limits::LIST_ITEMS),
    };
    Problem::new(Kind::TOO_LARGE, detail)
}

/// Returns the error of an incomplete body.
pub(super) fn broken() -> Problem {
    let detail = "the body is incomplete, or does not match its content-encoding";
    Problem::new(Kind::BAD_REQUEST, detail)
}

/// Returns the reason why a body is incomplete, which the layers below hide in a chain of errors.
pub fn unreadable(error: &axum::Error) -> Problem {
    fault_of_client(error).unwrap_or_else(broken)
}

/// Returns what a client did wrong with a body, if that is in a chain of errors.
pub fn fault_of_client(error: &(dyn Error + 'static)) -> Option<Problem> {
    let mut cause: Option<&(dyn Error + 'static)> = Some(error);
    while let Some(error) = cause {
        if error.is::<LengthLimitError>() {
            return Some(too_large());
        }
        if error.is::<TooSlow>() {
            return Some(Problem::new(Kind::TIMEOUT, "the body arrived too slowly"));
        }
        // An error inside an I/O error is not its source; that error's own source is.
        let inside = error.downcast_ref::<io::Error>().and_then(io::Error::get_ref);
        cause = match inside {
            Some(inside) => Some(inside),
            None => error.source(),
        };
    }
    None
}
