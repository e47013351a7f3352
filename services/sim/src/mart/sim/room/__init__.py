"""Run one room: its seats, barrier, episode and world, and what it says on the bus."""
