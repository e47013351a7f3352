"""Step many worlds on request, for training, evaluation and re-simulation."""
