"""Judging: checkpoints in worlds, by rollouts over the bus."""
