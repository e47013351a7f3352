"""MART's simulator: the shared world, the barrier that advances it, and scripted experts."""
