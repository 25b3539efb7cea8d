"""COLMAP: a sparse model (.bin or .txt), or a database of matches."""
