"""Datagrams between a controller and motors, little-endian.

A command is its number (64 bits), its mode (8 bits) and a value for every tendon (64-bit floats): tensions [N] or
shortenings [m]. A reading is the number of the command that it answers, then all tensions [N], all shortenings [m] and
the contact force [N], which is nan without a sensor.
"""

import struct
from typing import NamedTuple

import numpy as np

from rom.brief import brief

STOP, TENSION, POSITION = 0, 1, 2  # modes; motors that are stopped hold their positions
MODES = {"tension": TENSION, "position": POSITION}


@brief
class Command(NamedTuple):
    """A command to motors; values of t tendons, shape (t,) [N] or [m]."""

    number: int
    mode: int
    values: np.ndarray


@brief
class Reading(NamedTuple):
    """Measurements after command `number`: tensions [N], shortenings [m], shapes (t,), contact force [N]."""

    number: int
    tensions: np.ndarray
    shortenings: np.ndarray
    contact_force: float


def packed_command(command: Command) -> bytes:
    """A command as a datagram."""
    return struct.pack(f"<QB{len(command.values)}d", command.number, command.mode, *command.values)


def packed_reading(reading: Reading) -> bytes:
    """A reading as a datagram."""
    values = (*reading.tensions, *reading.shortenings, reading.contact_force)
    return struct.pack(f"<Q{len(values)}d", reading.number, *values)


def command_of(datagram: bytes, tendons: int) -> Command | None:
    """Return the command in a datagram; None if its length or kind is wrong, or a value is not finite."""
    layout = f"<QB{tendons}d"
    if len(datagram) != struct.calcsize(layout):
        return None
    number, mode, *values = struct.unpack(layout, datagram)
    valid = mode in (STOP, TENSION, POSITION) and np.isfinite(values).all()
    return Command(number, mode, np.array(values)) if valid else None


def reading_of(datagram: bytes, tendons: int) -> Reading | None:
    """The reading of a datagram; None if it is none of so many tendons, or a tension or shortening is not finite."""
    layout = f"<Q{2 * tendons + 1}d"
    if len(datagram) != struct.calcsize(layout):
        return None
    number, *values = struct.unpack(layout, datagram)
    tensions, shortenings = np.array(values[:tendons]), np.array(values[tendons:-1])
    finite = np.isfinite(tensions).all() and np.isfinite(shortenings).all()
    return Reading(number, tensions, shortenings, values[-1]) if finite else None
