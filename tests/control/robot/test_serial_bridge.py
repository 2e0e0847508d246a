"""Motors on a serial line: frames keep datagrams, bytes that are lost or changed cost a frame, and a link works."""

import os
import tty
from io import FileIO

import numpy as np
import pytest

import rom
from control.robot import Link, SerialBridge, SimulatedMotors
from control.robot.serial_bridge import BLOCK, datagram_of, framed

WAIT = 5.0  # for bytes that are on their way [s]


@pytest.fixture
def lines():
    """Both ends of a pseudo terminal."""
    ends = os.openpty()
    for end in ends:
        tty.setraw(end)
    opened = [FileIO(end, "r+") for end in ends]
    yield opened
    for one in opened:
        one.close()


@pytest.mark.parametrize("size", [0, 1, 25, BLOCK - 5, BLOCK - 4, BLOCK - 3, 2 * BLOCK, 1000])
@pytest.mark.parametrize("zeros", [0.0, 0.1, 1.0])
def test_a_frame_has_one_zero_and_keeps_its_datagram(size, zeros):
    random = np.random.default_rng(size)
    bytes_ = np.where(random.random(size) < zeros, 0, random.integers(1, 256, size)).astype(np.uint8).tobytes()
    frame = framed(bytes_)
    assert frame.count(0) == 1 and frame[-1] == 0 and datagram_of(frame[:-1]) == bytes_


def test_a_lost_or_changed_byte_costs_the_frame():
    frame, random = framed(bytes(range(60)))[:-1], np.random.default_rng(0)
    assert datagram_of(b"") is None
    for k in range(len(frame)):
        assert datagram_of(frame[:k] + frame[k + 1 :]) is None
        changed = bytearray(frame)
        changed[k] ^= int(random.integers(1, 256))
        assert datagram_of(bytes(changed)) is None


def test_motors_behind_a_line_answer_a_link(lines):
    model = rom.load()
    motors = SimulatedMotors(model, 0.012)
    bridge, robot = SerialBridge(lines[0]), SerialBridge(lines[1], motors.address)
    link = Link(bridge.address, 2)
    for tension in (10.0, 40.0):
        link.send([tension, 5.0])
        # the command, then the reading
        assert bridge.forward(WAIT) and robot.forward(WAIT) and motors.serve(WAIT)
        assert robot.forward(WAIT) and bridge.forward(WAIT)
        sample = link.receive(WAIT)
        assert sample.status == "fresh" and sample.reading.tensions == pytest.approx([tension, 5.0], abs=0)
    assert sample.reading.contact_force == model.evaluate([40.0, 5.0], d=0.012).contact_force
    assert bridge.broken == robot.broken == 0 and bridge.forward() == 0
    for one in (link, bridge, robot, motors):
        one.close()


def test_a_reading_whose_bytes_changed_is_missing_and_the_next_one_counts(lines):
    bridge = SerialBridge(lines[0])
    link = Link(bridge.address, 2)
    link.send([10.0, 5.0])
    assert bridge.forward(WAIT)
    lines[1].write(b"\x05noise\x00" + framed(b"no reading") + framed(b"begun")[:3])
    assert bridge.forward(WAIT) == 1 and bridge.broken == 1
    assert link.receive(0.1).status == "held" and link.counts.refused == 1
    link.close()
    bridge.close()
