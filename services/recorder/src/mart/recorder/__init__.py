"""The recorder: one MCAP file per episode, verified by re-simulation, with its catalogue, labels and repair."""
