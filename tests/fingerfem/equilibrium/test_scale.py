"""A finger of millimetres and one of metres are one finger, by the same numbers in scaled units."""

from pathlib import Path

import numpy as np
import pytest
from farm import run

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.fitting.training import train
from rom.elements.samples.section_states import read_section_states
from rom.rod.objects.shapes import Plane
from rom.rod.rod import Rod
from rom.rod.touched_segment import TouchedSegment

SEGMENTS = 5
LENGTHS = 1e-3, 1.0  # of a segment [m]; no length may exceed 1 m
C1 = 1.9e6  # [Pa], of both: so are steel plates
SPHERE = {"shape": "sphere", "radius": 0.6, "centre": [4.5, 1.2, 0.1]}  # over a segment's length


def finger(length: float, **obstacle) -> FingerModel:
    scaled = {name: (length * np.array(obstacle[name])).tolist() for name in ("radius", "centre") if name in obstacle}
    unit = C1 * (0.25 * length) ** 2  # [N]
    table = {
        "name": "scaled",
        "geometry": {"side": 0.25 * length, "segments": [length] * SEGMENTS, "plate": 0.05 * length},
        "material": {"law": "neo-hookean", "C1": C1, "D1": 0.4617 / C1},
        "tendons": [
            {"name": "F1", "offset": [0.1 * length, 0.0], "segment": SEGMENTS, "tension": [0.0, 0.05 * unit]},
            {"name": "F2", "offset": [0.0, 0.1 * length], "segment": 2, "tension": [0.0, 0.05 * unit]},
        ],
        "obstacle": {"distance": [0.01 * length, length]} | obstacle | scaled,
        "mesh": {"cells": [8, 5]},
    }
    return FingerModel(Scene.model_validate(table))


def figures(length: float, **obstacle) -> list[np.ndarray]:
    """Figures of a bent and of a pressed state, over the units of length and force."""
    model, force = finger(length, **obstacle), C1 * length**2
    tensions = np.array([0.02, 0.01]) * C1 * (0.25 * length) ** 2
    free = model.solve(tensions)
    assert free.touch_distance is not None
    pressed = model.solve(tensions, free.touch_distance - 0.01 * length)
    found = []
    for state in (free, pressed):
        by = state.sensitivities
        found += [
            state.displacement / length,
            state.tip / length,
            np.array(list(state.channel_shortening.values())) / length,
            np.array([state.energy / (force * length), state.smallest_volume_ratio]),
            np.array([by["tip"][name] for name in ("F1", "F2")]) * force / length,
        ]
    by = pressed.sensitivities["contact_force"]
    forces = [pressed.contact_force / force, *pressed.clamp_reaction / force, by["F1"], by["d"] * length / force]
    return [*found, np.array([free.touch_distance / length]), np.array(forces)]


@pytest.mark.parametrize("obstacle", [{}, pytest.param(SPHERE, marks=pytest.mark.long)], ids=["plane", "sphere"])
def test_fingers_of_5_mm_and_of_5_m_have_the_same_figures(obstacle):
    small, large = (figures(length, **obstacle) for length in LENGTHS)
    assert large[-1][0] > 0 and np.isfinite(np.concatenate([part.ravel() for part in small])).all()
    for ours, theirs in zip(small, large, strict=True):
        assert np.abs(ours - theirs).max() < 1e-6 * np.abs(theirs).max()


def trained(length: float, folder: Path) -> Rod:
    """The map of one segment, from few states, whose field has a node for each of the mesh's."""
    folder.mkdir()
    unit = C1 * (0.2 * length) ** 2
    (folder / "scene.toml").write_text(
        f"""
name = "scaled"
[geometry]
side = {0.2 * length}
segments = [{length}]
plate = {0.04 * length}
[material]
law = "neo-hookean"
C1 = {C1}
D1 = {0.4617 / C1}
[[tendons]]
name = "F1"
offset = [{0.08 * length}, 0.0]
segment = 1
tension = [0.0, {0.12 * unit}]
[load]
force = {0.02 * unit}
[mesh]
cells = [9, 5]
[sampling]
lines = 8
"""
    )
    run(2, folder / "scene.toml", folder / "set")
    states = read_section_states(SnapshotSet(folder / "set"))
    return Rod(elements=train(states, {}), scene=states.scene)


@pytest.mark.long
def test_elements_of_a_finger_of_5_mm_and_of_one_of_1_m_give_the_same_figures(tmp_path):
    lengths = 5e-3, 1.0  # [m]
    small, large = (trained(length, tmp_path / str(length)) for length in lengths)
    assert large.errors.contact_force == pytest.approx(small.errors.contact_force, rel=1e-3)
    found = []
    for rod, length in zip((small, large), lengths, strict=True):
        unit = C1 * (0.2 * length) ** 2
        plane = Plane(centre=(0, 0.1 * length, 0), normal=(0, -1, 0), direction=(0, 1, 0))
        model = TouchedSegment(rod=rod, obstacle=plane)
        free = model.evaluate([0.1 * unit, np.inf])
        pressed = model.evaluate([0.1 * unit, free.touch_distance - 0.01 * length])
        found.append([*free.tip / length, free.touch_distance / length, pressed.contact_force / unit])
    assert found[0][-1] > 0 and np.isfinite(found).all()
    assert np.abs(np.subtract(*found)).max() < 1e-6 * np.abs(found).max()
