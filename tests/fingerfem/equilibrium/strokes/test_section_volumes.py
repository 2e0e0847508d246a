"""Volumes of chambers up to every cross-section: their sum, their derivatives, and what they do not depend on."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.model import FingerModel
from fingerfem.scene.scene import Scene
from fingerfem.snapshots.design import cross_sections
from fingerfem.snapshots.recorder import Recorder

CHAMBERS = [
    {"name": "p1", "region": "rectangle", "centre": [-0.0055, 0.0], "size": [0.005, 0.012], "x": [0.004, 0.054]},
    {"name": "p2", "region": "rectangle", "centre": [0.0055, 0.0], "size": [0.005, 0.012], "x": [0.004, 0.054]},
]
TABLE = {
    "name": "finger",
    "geometry": {"side": 0.020, "segments": [0.060], "plate": 0.002, "channel": 0.003},
    "material": {"law": "neo-hookean", "C1": 1e5, "D1": 2e-6},
    "tendons": [{"name": "F1", "offset": [0.0, 0.0], "segment": 1, "tension": [0.0, 20.0]}],
    "chambers": [one | {"pressure": [0.0, 3e4]} for one in CHAMBERS],
    "load": {"force": 0.5},
    "mesh": {"cells": [8, 7]},
}
LOADS = np.array([4.0, 2e4, 5e3])


@pytest.fixture(scope="module")
def finger():
    return FingerModel(Scene.model_validate(TABLE))


@pytest.fixture(scope="module")
def numbering(finger):
    return NodeOrder(finger.problem)


def recorded(finger, numbering, loads, wrenches=None):
    finger.continuation.rest()
    finger.continuation.advance(loads, None)
    record = Recorder(finger, numbering)
    record.state(loads, None, 0, wrenches)
    return {name: values[0] for name, values in record.arrays().items()}


@pytest.fixture(scope="module")
def free(finger, numbering):
    return recorded(finger, numbering, LOADS)


def test_strokes_end_with_those_of_whole_tendons_and_chambers(finger, free):
    state = finger.solve(LOADS, sensitivities=False)
    whole = [state.channel_shortening["F1"], *state.chamber_volumes.values()] - np.append(
        0, finger.problem.rest_volumes
    )
    assert free["section_shortening"][-1] == pytest.approx(whole, rel=1e-9)
    assert (free["section_shortening"][0] == 0).all()
    assert (np.diff(free["section_shortening"][:, 1]) > 0).sum() > 6  # it grows along its whole length


def test_work_is_the_change_of_energy(finger, numbering, free):
    """dW = F ds + p dV; the strokes have one potential, so their derivatives are symmetric."""
    by = free["section_shortening_jacobian"][-1, :, :3]
    assert by == pytest.approx(by.T, abs=1e-6 * np.sqrt(np.outer(np.diag(by), np.diag(by))).max())
    assert abs(by[1, 0] - by[0, 1]) < 1e-6 * abs(by[1, 0]) and abs(by[2, 1] - by[1, 2]) < 1e-6 * abs(by[2, 1])
    energies = []
    for step in (-1.0, 1.0):
        finger.solve(LOADS + np.array([0.0, step, 0.0]), sensitivities=False)
        energies.append(finger.problem.scalar(finger.problem.forms.strain_energy))
    assert (energies[1] - energies[0]) / 2 == pytest.approx(LOADS @ by[:, 1], rel=1e-6)


def test_derivatives_are_differences_of_states(finger, numbering, free):
    wrench = np.array([[0.05, 0.1, 0.08, 2e-4, -3e-4, 5e-4]])
    state = recorded(finger, numbering, LOADS, wrench)
    for k, step in ((0, 1e-3), (1, 1.0), (3, 1e-4), (7, 1e-6)):
        ends = []
        for sign in (-1, 1):
            loads, pressed = LOADS.copy(), wrench.copy()
            (loads if k < 3 else pressed[0])[k if k < 3 else k - 3] += sign * step
            ends.append(recorded(finger, numbering, loads, pressed))
        for name in ("section_shortening", "section_place", "section_corners"):
            expected = (ends[1][name] - ends[0][name]) / (2 * step)
            found, size = state[f"{name}_jacobian"][..., k], np.abs(expected).reshape(len(expected), -1).max(axis=0)
            off = np.abs(found - expected).reshape(len(expected), -1).max(axis=0)
            assert (off <= 2e-5 * size + 1e-12 * size.max()).all(), name


def test_the_volume_between_two_sections_does_not_change_with_a_rigid_motion(finger, numbering):
    """The motion is of the part beyond a section: the volume is then an element's own."""
    problem, nodes = finger.problem, numbering.nodes
    draw = np.random.default_rng(0).uniform(-1, 1, nodes.shape) * 2e-4
    turn, sections = Rotation.from_rotvec([0.3, -0.5, 0.8]), cross_sections(finger.scene, nodes)
    found = []
    for field in (draw, turn.apply(nodes + draw) - nodes + np.array([0.01, -0.02, 0.005])):
        problem.displacement[:] = numbering.scatter(field)
        places = sections.quantities(field, np.zeros((0, *nodes.shape)))
        integrals = finger.section_volumes.integrals(np.zeros((0, problem.displacement.size)))
        volumes, _ = integrals.volumes(places["section_place"], places["section_place_jacobian"])
        found.append(np.diff(volumes, axis=0))
    assert found[1] == pytest.approx(found[0], abs=1e-12 * found[0].max())
    finger.continuation.rest()


def test_a_section_s_position_is_that_of_its_rubber(finger, numbering):
    """Sections beside the chambers and through them have one definition: nodes within a void count nowhere."""
    nodes = numbering.nodes
    sections = cross_sections(finger.scene, nodes)
    field = np.zeros_like(nodes)
    inside = (np.abs(np.abs(nodes[:, 1]) - 0.0055) < 0.0024) & (np.abs(nodes[:, 2]) < 0.0059)
    field[inside] = [1e-3, 2e-3, 3e-3]
    at_rest = sections.quantities(0 * nodes, np.zeros((0, *nodes.shape)))["section_place"]
    assert sections.quantities(field, np.zeros((0, *nodes.shape)))["section_place"] == pytest.approx(at_rest, abs=1e-15)


def test_a_section_s_position_is_that_of_the_axis_where_a_chamber_lies_on_one_side():
    """A rigid motion moves it as the axis itself moves, and its derivatives are differences."""
    one = FingerModel(Scene.model_validate(TABLE | {"chambers": TABLE["chambers"][:1]}))
    nodes = NodeOrder(one.problem).nodes
    sections, none = cross_sections(one.scene, nodes), np.zeros((0, *nodes.shape))
    turn, shift = Rotation.from_rotvec([0.3, -0.5, 0.8]), np.array([0.01, -0.02, 0.005])
    moved = turn.apply(nodes) + shift - nodes
    axis = np.outer(sections.positions, [1.0, 0.0, 0.0])
    assert sections.quantities(0 * nodes, none)["section_place"] == pytest.approx(axis, abs=1e-15)
    assert sections.quantities(moved, none)["section_place"] == pytest.approx(turn.apply(axis) + shift, abs=1e-15)
    draw = np.random.default_rng(1).standard_normal((2, *nodes.shape)) * 1e-3
    ends = [sections.quantities(draw[0] + step * draw[1], none)["section_place"] for step in (-1e-3, 1e-3)]
    found = sections.quantities(draw[0], draw[1:])["section_place_jacobian"][..., 0]
    assert found == pytest.approx((ends[1] - ends[0]) / 2e-3, abs=1e-6 * np.abs(found).max())
