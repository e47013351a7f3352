"""Trainings in a queue that survives whatever happens to the trainer."""
