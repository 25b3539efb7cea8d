"""A small building to try the package on: rendered corridors that look alike."""
