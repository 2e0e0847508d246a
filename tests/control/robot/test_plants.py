"""Controllers that run on logs, and on motors over UDP, with a force sensor and without."""

import socket
import threading

import numpy as np
import pytest

import rom
from control import GraspOptions, Gripper, Limits, run
from control.feel import KnownObjects, Noise
from control.log import read_log
from control.robot import Link, LinkedPlant, ReplayedPlant, SimulatedMotors

DISTANCE, TARGET = 0.012, 1.0  # [m], [N]
OPTIONS = GraspOptions(approach_step=0.5, squeeze_steps=50, tolerance=0.05, noise=0.02, feel=0.1)


@pytest.fixture(scope="module")
def gripper():
    return Gripper(rom.load(), fingers=1, limits=Limits(rate=2000.0))


def served(motors, ended):
    while not ended.is_set():
        motors.serve(0.01)


def held(gripper, **options):
    """The true force at the end of a loop over UDP, the report, and the plant."""
    motors = SimulatedMotors(gripper.model, DISTANCE, sensor="felt" not in options)
    ended = threading.Event()
    server = threading.Thread(target=served, args=(motors, ended))
    server.start()
    try:
        with Link(motors.address, 2) as link:
            plant = LinkedPlant(link, wait=10.0, **options)  # for every reply, whatever the machine's load
            report = run(gripper.grips(TARGET, OPTIONS), [plant], 300)
            return motors.contact_force, report, plant
    finally:
        ended.set()
        server.join()
        motors.close()


def test_a_force_is_held_over_udp(gripper):
    force, report, plant = held(gripper)
    assert report.status == ["converged"] and force == pytest.approx(TARGET, rel=0.05)
    assert plant.sample.status == "fresh" and report.unread == 0


def test_a_force_is_held_without_a_sensor(gripper):
    sensed = KnownObjects(gripper.model, Noise(shortening=2e-6, tension=1e-3))

    def felt(reading):
        return float(sensed.feel(reading.tensions, reading.shortenings).contact_forces[0])

    force, report, _ = held(gripper, felt=felt)
    assert report.status == ["converged"] and force == pytest.approx(TARGET, rel=0.05)


def test_a_force_is_held_by_positions(gripper):
    def positions(tensions):
        return gripper.model.evaluate([*tensions, DISTANCE]).shortenings

    force, report, _ = held(gripper, positions=positions)
    assert report.status == ["converged"] and force == pytest.approx(TARGET, rel=0.05)


def test_a_finger_that_nobody_drives_has_no_force_and_stops():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as nobody:
        nobody.bind(("127.0.0.1", 0))
        address = nobody.getsockname()
    with Link(address, 2, patience=3) as link:
        plant = LinkedPlant(link)
        assert all(np.isnan(plant.pull([30.0, 5.0])) for _ in range(5))
    assert plant.sample.status == "stopped" and plant.age == pytest.approx(5e-3) and link.counts.missing == 5


@pytest.fixture
def log(tmp_path, gripper):
    """A finger that closes slowly; rows come every 2 ms, two are missing, one has no force."""
    model, rows = gripper.model, ["t [ms],F1 [N],F2 [N],F1 [mm],F2 [mm],contact force [mN]"]
    for k in range(60):
        tensions = [float(k), 2.0]
        answer = model.evaluate([*tensions, DISTANCE])
        force = "" if k == 50 else f"{1e3 * answer.contact_force:.6f}"
        if k not in (30, 31):
            shorter = ",".join(f"{1e3 * one:.9f}" for one in answer.shortenings)
            rows.append(f"{2 * k},{tensions[0]},{tensions[1]},{shorter},{force}")
    file = tmp_path / "log.csv"
    file.write_text("\n".join(rows))
    return read_log(file, ["F1", "F2"])


def test_a_log_is_replayed_by_its_times(log, gripper):
    plant = ReplayedPlant(log)
    assert plant.periods == 119
    forces, ages = [], []
    for _ in range(plant.periods):
        forces.append(plant.pull([0.0, 0.0]))
        ages.append(round(1e3 * plant.age))
    assert ages[:5] == [0, 1, 0, 1, 0] and ages[58:65] == [0, 1, 2, 3, 4, 5, 0]
    assert [k for k, one in enumerate(forces) if np.isnan(one)] == [100, 101]
    assert forces[110] == pytest.approx(gripper.model.evaluate([55.0, 2.0, DISTANCE]).contact_force, abs=1e-6)


def test_a_log_without_forces_is_felt(log, gripper):
    sensed = KnownObjects(gripper.model, Noise(shortening=2e-6, tension=1e-3))
    plant = ReplayedPlant(log, felt=lambda one: float(sensed.feel(one.tensions, one.shortenings).contact_forces[0]))
    forces = [plant.pull([0.0, 0.0]) for _ in range(plant.periods)]
    assert forces[100] == pytest.approx(gripper.model.evaluate([50.0, 2.0, DISTANCE]).contact_force, abs=2e-3)


def test_controllers_run_on_a_log(log, gripper):
    plant = ReplayedPlant(log)
    report = run(gripper.grips(TARGET, OPTIONS), [plant], plant.periods)
    assert report.periods == 119 and report.unread == 0
    assert np.count_nonzero(np.isnan(report.felt)) == 2


def test_a_log_that_lacks_a_column_is_refused(tmp_path):
    file = tmp_path / "log.csv"
    file.write_text("F1 [N],F2 [N]\n1,2\n")
    with pytest.raises(ValueError, match="must have columns of contact force, got no contact force"):
        ReplayedPlant(read_log(file, ["F1", "F2"]))
    with pytest.raises(ValueError, match="must have columns of tension and shortening, got no shortening"):
        ReplayedPlant(read_log(file, ["F1", "F2"]), felt=lambda one: 0.0)
