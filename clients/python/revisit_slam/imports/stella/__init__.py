"""stella_vslam: its map as an SQLite database or as MessagePack."""
