"""Connect an arm of your own to a room: implement `Driver`, and let `mart driver` run it beside the hardware.

    mart driver --room room-1 --arm arm0 --driver my_arm:MyArm --option address=192.168.0.10

`docs/how-to-run-real-arms.md` says what a driver must do, and what is checked around it.
"""

from mart.driver.interface import Driver, DriverFault, Measured

__all__ = ["Driver", "DriverFault", "Measured"]
