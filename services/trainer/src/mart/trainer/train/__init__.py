"""Training: from episodes to a run's checkpoints."""
