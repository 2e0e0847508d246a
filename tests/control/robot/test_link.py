"""Motors over UDP on the loopback: readings that are late or lost are marked, held, and end in a stop."""

import socket

import numpy as np
import pytest

from control.robot import Link, Losses, SimulatedMotors
from control.robot.messages import Command, Reading, command_of, packed_command, packed_reading, reading_of

DISTANCE = 0.012  # [m]
WAIT = 5.0  # for a datagram that is on its way [s]
PULLED = [40.0, 5.0]  # [N]


@pytest.fixture
def connected(model):
    """A function that connects a link to simulated motors whose replies have losses."""
    opened = []

    def connect(losses=None, patience=20, **options):
        motors = SimulatedMotors(model, DISTANCE, losses=losses, **options)
        opened.extend([Link(motors.address, 2, patience), motors])
        return opened[-2], motors

    yield connect
    for one in opened:
        one.close()


def period(link, motors, values=PULLED, mode="tension"):
    """A period: the motors answer between command and reading."""
    link.send(values, mode)
    motors.serve(WAIT)
    return link.receive()


def test_every_command_is_answered_by_a_fresh_reading(connected, model):
    link, motors = connected()
    for _ in range(50):
        sample = period(link, motors)
        assert sample.status == "fresh" and sample.age == 0
    answer = model.evaluate([*PULLED, DISTANCE])
    assert sample.reading.number == 50 and sample.reading.tensions.tolist() == PULLED
    assert sample.reading.shortenings.tolist() == answer.shortenings.tolist()
    assert sample.reading.contact_force == answer.contact_force == motors.contact_force
    assert vars(link.counts) == {"late": 0, "overtaken": 0, "refused": 0, "missing": 0}


def test_positions_are_reached_where_the_object_presses(connected, model):
    link, motors = connected()
    wanted = model.evaluate([*PULLED, DISTANCE]).shortenings
    sample = period(link, motors, wanted, "position")
    assert sample.reading.shortenings == pytest.approx(wanted, abs=1e-6)
    assert sample.reading.tensions == pytest.approx(PULLED, abs=1e-2)


def test_lost_readings_are_held_and_counted(connected):
    link, motors = connected(Losses(lost=[3, 4]))
    samples = [period(link, motors) for _ in range(6)]
    assert [one.status for one in samples] == ["fresh", "fresh", "held", "held", "fresh", "fresh"]
    assert [one.age for one in samples] == [0, 0, 1, 2, 0, 0]
    assert [one.reading.number for one in samples] == [1, 2, 2, 2, 5, 6]
    assert link.counts.missing == 2 and not link.stopped


def test_late_readings_are_marked_with_their_age(connected):
    link, motors = connected(Losses(late=dict.fromkeys(range(3, 100), 2)))
    samples = [period(link, motors) for _ in range(8)]
    assert [one.status for one in samples] == ["fresh", "fresh", "held", "held", *["late"] * 4]
    assert [one.age for one in samples] == [0, 0, 1, 2, 2, 2, 2, 2]
    assert link.counts.late == 4 and link.counts.missing == 2


def test_a_reading_that_a_newer_one_has_overtaken_does_not_count(connected):
    link, motors = connected(Losses(late={2: 2}))
    samples = [period(link, motors) for _ in range(4)]
    assert [one.status for one in samples] == ["fresh", "held", "fresh", "fresh"]
    assert link.counts.overtaken == 1 and link.counts.late == 0


def test_too_many_missing_readings_stop_motors_and_link(connected):
    link, motors = connected(Losses(lost=range(3, 6)), patience=3)
    samples = [period(link, motors) for _ in range(5)]
    assert [one.status for one in samples] == ["fresh", "fresh", "held", "held", "stopped"]
    assert link.stopped and not motors.holding
    sample = period(link, motors, [90.0, 5.0])
    assert motors.holding and sample.status == "stopped" and sample.reading.tensions.tolist() == PULLED
    link.restart()
    assert period(link, motors).status == "fresh" and not motors.holding


def test_motors_hold_where_commands_stay_away(connected):
    link, motors = connected(patience=5)
    period(link, motors)
    for _ in range(19):
        assert motors.serve() == 0 and not motors.holding
    motors.serve()
    assert motors.holding
    assert period(link, motors).status == "fresh" and not motors.holding


def test_without_motors_readings_are_missing():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as nobody:
        nobody.bind(("127.0.0.1", 0))
        address = nobody.getsockname()
    with Link(address, 2, patience=2) as link:
        found = []
        for _ in range(3):
            link.send(PULLED)
            found.append(link.receive())
    assert [one.status for one in found] == ["held", "stopped", "stopped"] and found[0].reading is None


def test_strange_datagrams_are_refused(connected):
    link, motors = connected()
    link.send(PULLED)
    motors.serve(WAIT)
    future = Reading(99, np.zeros(2), np.zeros(2), 0.0)
    broken = Reading(1, np.array([np.nan, 0.0]), np.zeros(2), 0.0)
    for datagram in (b"", b"hello", packed_reading(future), packed_reading(broken)):
        motors._socket.sendto(datagram, link._socket.getsockname())
    sample = link.receive(0.0)
    assert sample.status == "fresh" and link.counts.refused == 4


def test_messages_come_back_as_they_were():
    command = Command(7, 2, np.array([0.001, -0.002]))
    found = command_of(packed_command(command), 2)
    assert found[:2] == command[:2] and found.values.tolist() == command.values.tolist()
    assert (
        command_of(packed_command(command), 3) is None
        and command_of(packed_command(command._replace(mode=9)), 2) is None
        and command_of(packed_command(command._replace(values=np.array([1.0, np.nan]))), 2) is None
    )
    reading = reading_of(packed_reading(Reading(3, np.ones(2), np.zeros(2), np.nan)), 2)
    assert reading.number == 3 and np.isnan(reading.contact_force)


def test_wrong_arguments_are_refused(connected):
    link, _ = connected()
    for values, mode, said in (
        ([1.0], "tension", "values must be 2 finite numbers"),
        ([np.nan, 1.0], "tension", "values must be 2 finite numbers"),
        (PULLED, "torque", "mode must be one of tension, position, got torque"),
    ):
        with pytest.raises(ValueError, match=said):
            link.send(values, mode)
    with pytest.raises(ValueError, match="patience must be at least 1"):
        Link(("127.0.0.1", 9), 2, patience=0)
