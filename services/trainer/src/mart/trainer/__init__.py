"""Fits policies to recorded episodes, judges them and seats them beside people."""

import os

# PyTorch's threads spin while they wait for each other. Where other programs use the cores, too, an update of HBC then
# takes six times as long as by threads that sleep (docs/decisions/0081). Read once, when torch is loaded.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")
