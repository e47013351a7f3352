"""Certificates by which the parts of a platform know each other, between machines."""
