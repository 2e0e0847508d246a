"""Loads as functions of time, read from files; what they cannot be is refused in one line."""

import numpy as np
import pytest

from fingerfem.dynamics.motion import motion_of, read_motion
from fingerfem.dynamics.signals import read_signal
from fingerfem.scene.scene import Scene

TIME = {"end": 1.0, "step": 0.1}


@pytest.fixture
def scene(moving) -> Scene:
    return Scene.model_validate(moving | {"obstacle": {"distance": [0.001, 0.031]}})


def test_points_are_joined_by_lines_and_jump_between_two_of_one_time():
    signal = read_signal("F1", [[0.1, 1.0], [0.3, 3.0], [0.3, 7.0], [0.5, 6.0]])
    assert [signal.value(t, after=True) for t in (0.0, 0.2, 0.3, 0.4, 9.0)] == pytest.approx([1.0, 2.0, 7.0, 6.5, 6.0])
    assert signal.value(0.3, after=False) == 3.0 and signal.has_jumps
    assert [signal.slope(0.3, after=after) for after in (False, True)] == pytest.approx([10.0, -5.0])
    assert read_signal("d", 0.01).value(5.0, after=False) == 0.01


def test_a_sine_has_its_formula_and_slope():
    signal = read_signal("F1", {"mean": 2.0, "amplitude": 1.5, "frequency": 3.0, "phase": 0.4})
    t, h = 0.21, 1e-6
    assert signal.value(t, after=True) == pytest.approx(2.0 + 1.5 * np.sin(2 * np.pi * 3.0 * t + 0.4))
    difference = (signal.value(t + h, after=True) - signal.value(t - h, after=True)) / (2 * h)
    assert signal.slope(t, after=True) == pytest.approx(difference, rel=1e-6)
    assert signal.limits == (0.5, 3.5)


def test_a_file_and_its_table_give_loads_breaks_and_jumps(scene, tmp_path):
    (tmp_path / "loads.csv").write_text("time, d\n0.0, 0.02\n0.4, 0.01\n")
    file = tmp_path / "motion.toml"
    file.write_text(
        'table = "loads.csv"\n[time]\nend = 1.0\nstep = 0.1\n[loads]\nF1 = [[0.2, 0.0], [0.2, 3.0]]\n'
        "[base]\nwz = [[0.0, 0.0], [0.6, 3.0]]\n"
    )
    motion = read_motion(file, scene)
    assert motion.breaks.tolist() == [0.2, 0.4, 0.6, 1.0]
    assert [motion.jumps(t) for t in (0.2, 0.4, 0.6)] == [True, False, True]  # at the last, the base's rate of spin
    tensions, distance = motion.loads(0.2, after=True)
    assert tensions.tolist() == [3.0] and distance == pytest.approx(0.015)
    assert motion.base(0.3, after=True).spin_rate.tolist() == [0.0, 0.0, 5.0]
    changed = motion_of({"time": TIME, "loads": {"F1": 3.0}}, scene)
    assert changed.digest != motion.digest


@pytest.mark.parametrize(
    ("tables", "rule"),
    [
        ({"loads": {"F1": 11.0}}, r"loads.F1 must lie in \[0, 10\] N, got 11"),
        ({"loads": {"F1": {"mean": 1.0, "amplitude": 2.0, "frequency": 1.0}}}, r"must lie in \[0, 10\] N, got -1"),
        ({"loads": {"F7": 1.0}}, "loads must be of F1, d, got F7"),
        ({"loads": {"F1": [[0.2, 1.0], [0.1, 2.0]]}}, "times that do not fall, got 0.1 s after 0.2 s"),
        ({"loads": {"F1": [[0.1, 1.0]] * 3}}, "at most two points of one time, got three at 0.1 s"),
        ({"loads": {"F1": {"amplitude": 1.0}}}, "loads.F1.frequency must be a finite number, got None"),
        ({"loads": {"F1": {"amplitude": 1.0, "frequency": 0.0}}}, "frequency must be above 0 Hz"),
        ({"loads": {"F1": {"amplitude": 1.0, "period": 1.0}}}, "must have the keys mean, .*, got period"),
        ({"loads": {"F1": "fast"}}, "must be a number, a list of .time, value. or a table of a sine, got 'fast'"),
        ({"base": {"vx": 1.0}}, "base must have the keys ax, .*, got vx"),
        ({"base": {"wz": [[0.1, 0.0], [0.1, 1.0]]}}, "base.wz must not jump"),
        ({"base": {"az": 1.0}}, "base.az must be left out where half a finger is modelled; set mesh.symmetry = false"),
        ({"table": "nowhere.csv"}, "table must be a file"),
    ],
)
def test_a_motion_that_cannot_be_is_refused(scene, tables, rule):
    with pytest.raises(ValueError, match=rule):
        motion_of({"time": TIME} | tables, scene)


def test_a_file_with_a_wrong_key_is_named(scene, tmp_path):
    file = tmp_path / "motion.toml"
    file.write_text("[time]\nend = 1.0\nstep = -0.1\n")
    with pytest.raises(ValueError, match=r"motion.toml: time.step must be above 0, got -0.1"):
        read_motion(file, scene)
