"""Draw pictures of a MuJoCo world without a display: the one renderer of the simulator and the gateway."""
