"""From photographs to keyframes: features, words, rotations and signs."""
