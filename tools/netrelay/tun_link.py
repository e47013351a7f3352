"""Make a network namespace whose only way out is this process: a TUN device there, one here.

The device in the namespace is a file of this process all the same, so every IP packet between both can be read and
written. What runs there needs no word of it: WebRTC, HTTPS and Zenoh pass unmodified, and TCP really loses packets.
It takes root, or root of a user namespace (`unshare -Urnm` with a tmpfs on /run/netns), and /dev/net/tun.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import struct
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass

from mart.protocol.errors import Unavailable

_TUNSETIFF = 0x400454CA
_TUN_WITHOUT_HEADER = 0x0001 | 0x1000  # IFF_TUN | IFF_NO_PI
_MTU = 1500


@dataclass(frozen=True)
class TunLink:
    """Hold both devices, as descriptors that do not block, and the address at each end."""

    near: int
    far: int
    near_address: str
    far_address: str


@contextlib.contextmanager
def tun_link(namespace: str, number: int) -> Iterator[TunLink]:
    """Make the namespace and both devices for the block: 10.77.NUMBER.1 here, 10.77.NUMBER.2 there.

    Raises Unavailable where this process may not, or where the namespace is there already.
    """
    near_address, far_address = f"10.77.{number}.1", f"10.77.{number}.2"
    _ip("netns", "add", namespace)
    with contextlib.ExitStack() as stack:
        stack.callback(_ip, "netns", "delete", namespace)
        near, far = (_open_tun(f"nr{number}{end}") for end in ("near", "far"))
        stack.callback(os.close, near)
        stack.callback(os.close, far)
        _set_up(f"nr{number}near", near_address, far_address)
        _ip("link", "set", f"nr{number}far", "netns", namespace)
        inside = ("-n", namespace)
        _ip(*inside, "link", "set", f"nr{number}far", "name", "eth0")
        _set_up("eth0", far_address, near_address, *inside)
        _ip(*inside, "link", "set", "lo", "up")
        # Without a default route Chromium gathers no ICE candidate at all.
        _ip(*inside, "route", "add", "default", "via", near_address, "dev", "eth0")
        yield TunLink(near, far, near_address, far_address)


def _set_up(device: str, address: str, peer: str, *inside: str) -> None:
    _ip(*inside, "link", "set", device, "mtu", str(_MTU), "txqueuelen", "5000")
    _ip(*inside, "link", "set", device, "addrgenmode", "none")  # IPv4 only
    _ip(*inside, "address", "add", address, "peer", peer, "dev", device)
    _ip(*inside, "link", "set", device, "up")


def _open_tun(name: str) -> int:
    try:
        device = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
        fcntl.ioctl(device, _TUNSETIFF, struct.pack("16sH22x", name.encode(), _TUN_WITHOUT_HEADER))
    except OSError as error:
        raise Unavailable(f"No TUN device can be made here: {error.strerror}. It takes root.") from error
    return device


def _ip(*words: str) -> None:
    try:
        subprocess.run(["ip", *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    except (OSError, subprocess.CalledProcessError) as error:
        said = error.stderr.decode().strip() if isinstance(error, subprocess.CalledProcessError) else error
        raise Unavailable(f"`ip {' '.join(words)}` failed: {said}. It takes root and iproute2.") from error
