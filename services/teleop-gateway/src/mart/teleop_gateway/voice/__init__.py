"""Carry what people of a room say to each other, as the packets that their browsers encoded."""
