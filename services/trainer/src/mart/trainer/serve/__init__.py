"""Policies in seats: states in, commands out, beside people."""
