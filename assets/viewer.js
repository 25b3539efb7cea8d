// Placeholder: the viewer follows.
