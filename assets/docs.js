// Placeholder: the reference follows.
