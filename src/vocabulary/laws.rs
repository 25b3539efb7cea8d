//! Small vocabularies by hand, and every way a file can be wrong.
