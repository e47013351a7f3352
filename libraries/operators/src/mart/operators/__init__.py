"""Drive a seat of a room: what scripts, policies and other people's operators share."""
