//! Matches against a plain double loop.
