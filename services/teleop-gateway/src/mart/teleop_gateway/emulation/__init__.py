"""Drive a seat as a phone does, without a phone."""
