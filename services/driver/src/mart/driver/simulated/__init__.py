"""Rehearse without an arm: hardware of software behind a socket, in a process and with a clock of its own.

    python -m mart.driver.simulated --port 9000
    mart driver --arm arm0 --driver mart.driver.simulated:SimulatedArm --option address=127.0.0.1:9000

It has joints that follow with a lag, and faults on request. It knows nothing of the things on the table.
"""

from mart.driver.simulated.arm import SimulatedArm

__all__ = ["SimulatedArm"]
