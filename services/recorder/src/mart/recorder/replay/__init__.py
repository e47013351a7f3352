"""Send a recorded way to real arms: slower, from where it began, and never further than a room lets it."""
