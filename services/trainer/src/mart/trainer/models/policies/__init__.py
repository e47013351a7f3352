"""Policies as they act: what a checkpoint becomes when it is loaded."""
