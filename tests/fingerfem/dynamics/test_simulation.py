"""Steps adapt, are repeated smaller and give up with a reason; an interrupted motion goes on as if it had not been."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from fingerfem.__main__ import app
from fingerfem.dynamics import simulation as module
from fingerfem.dynamics.generalised_alpha import MotionStopped
from fingerfem.dynamics.motion import motion_of
from fingerfem.dynamics.records import Records
from fingerfem.dynamics.simulation import Simulation
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.scene.scene import Scene

LOADS = {"F1": [[0.0, 0.0], [0.02, 3.0], [0.03, 3.0], [0.03, 1.0]]}


def simulation_of(moving: dict, time: dict, loads: dict = LOADS) -> Simulation:
    scene = Scene.model_validate(moving)
    return Simulation(scene, motion_of({"time": time, "loads": loads}, scene))


def test_adaptive_steps_are_as_short_as_the_tolerance_needs(moving):
    found = []
    for time in ({"tolerance": 1e-3}, {"tolerance": 1e-4}, {"tolerance": 1e-5}):
        rows = []
        simulation_of(moving, {"end": 0.03, "step": 5e-3} | time).run(lambda row, _, rows=rows: rows.append(row))
        found.append((len(rows), np.array([rows[-1]["tip_x"], rows[-1]["tip_y"]])))
    (few, coarse), (more, middle), (most, fine) = found
    assert few < more < most
    assert np.linalg.norm(middle - fine) < 0.5 * np.linalg.norm(coarse - fine)
    assert np.linalg.norm(middle - fine) < 2e-3 * 0.05


def test_a_step_that_fails_is_repeated_smaller(moving):
    simulation = simulation_of(moving, {"end": 0.01, "step": 2e-3})
    whole, rows = simulation._stepper.step, []

    def step(state, end):
        if end - state.time > 1.1e-3:
            raise NotConverged("too long for this test")
        return whole(state, end)

    simulation._stepper.step = step
    simulation.run(lambda row, _: rows.append(row))
    assert rows[-1]["time"] == 0.01 and rows[-1]["repeated"] >= 1
    assert np.diff([row["time"] for row in rows]).max() < 1.1e-3


def test_a_motion_without_further_steps_ends_with_its_reason(moving, monkeypatch):
    monkeypatch.setattr(module, "MADE", -1.0)  # every step would make too much
    rows = []
    with pytest.raises(MotionStopped, match=r"no step leads on from 0 s: the step would make .* J of energy"):
        simulation_of(moving, {"end": 0.01, "step": 2e-3}).run(lambda row, _: rows.append(row))
    assert len(rows) == 1


def test_an_interrupted_motion_goes_on_to_the_same_rows(moving, tmp_path):
    moving["material"]["prony"] = [[0.3, 0.01]]
    time = {"end": 0.04, "step": 2e-3}
    whole = []
    simulation_of(moving, time).run(lambda row, _: whole.append(row))

    class Stopped(Exception):
        pass

    def until(count: int, records: Records):
        def report(row, moment):
            records(row, moment)
            if len(records.rows) == count:
                raise Stopped

        return report

    for count in (7, 16, 19):  # the second one is at the time of a jump
        simulation = simulation_of(moving, time)
        with pytest.raises(Stopped), Records(tmp_path, simulation.motion.digest) as records:
            simulation.run(until(count, records), records.moment)
    with Records(tmp_path, simulation.motion.digest) as records:
        simulation_of(moving, time).run(records, records.moment)
    assert len(records.rows) == len(whole)
    for one, other in zip(records.rows, whole, strict=True):
        assert one == pytest.approx(other, rel=1e-6, abs=1e-9)
    with pytest.raises(ValueError, match="must have this motion of this scene"):
        Records(tmp_path, "another")


def test_the_commands_write_rows_pictures_and_fields(tmp_path):
    scene, motion = tmp_path / "scene.toml", tmp_path / "motion.toml"
    scene.write_text(
        'name = "moving"\ngeometry = {side = 0.01, segments = [0.05], plate = 0.001}\ndensity = {rubber = 1100.0}\n'
        'material = {law = "neo-hookean", E = 1e6, nu = 0.3}\nmesh = {cells = [9, 5]}\n'
        'tendons = [{name = "F1", offset = [0.004, 0.0], segment = 1, tension = [0.0, 10.0]}]\n'
    )
    motion.write_text("[time]\nend = 0.01\nstep = 2e-3\n[loads]\nF1 = [[0.0, 0.0], [0.01, 2.0]]\n")
    words = ["simulate", str(scene), str(motion), "-o", str(tmp_path / "out"), "--json"]
    for _ in range(2):  # the second time there is nothing left to do
        done = CliRunner().invoke(app, words)
        found = json.loads(done.stdout)
        assert done.exit_code == 0 and found["converged"] and found["steps"] == 5 and found["tip_y"] > 1e-4
    assert (tmp_path / "out" / "motion.png").stat().st_size > 1e4
    assert len((tmp_path / "out" / "motion.csv").read_text().splitlines()) == 7
    options = ["--count", "3", "--picture", str(tmp_path / "modes.png"), "--paraview", str(tmp_path / "modes.vtu")]
    done = CliRunner().invoke(app, ["modes", str(scene), "F1=2", *options, "--json"])
    found = json.loads(done.stdout)
    assert done.exit_code == 0 and len(found["frequencies"]) == 3 and found["stable"]
    assert all((tmp_path / name).stat().st_size > 1e4 for name in ("modes.png", "modes.vtu"))


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"density": None}, r"density must be given for motion, as a table \[density\] with rubber, got none"),
        ({"obstacle": {"distance": [0.001, 0.03], "method": "nitsche"}}, "obstacle.method must be penalty for motion"),
    ],
)
def test_a_scene_that_lacks_what_a_motion_needs_is_refused(moving, changes, rule):
    with pytest.raises(ValueError, match=rule):
        simulation_of(moving | changes, {"end": 1.0, "step": 0.1}, {})
