"""Speak to a gateway as a phone does."""
