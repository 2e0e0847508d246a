"""Tapered fingers: their volume, tendons in channels that converge, and the balance and derivatives of equilibria."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import ufl
from dolfinx import fem
from pydantic import ValidationError
from scipy.integrate import dblquad

from fingerfem import FingerModel
from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.scene.scene import Scene
from fingerfem.snapshots.design import cross_sections
from rom import Cylinder, Rod, TouchedSegment
from rom.dataset.snapshot_set import SnapshotError
from rom.elements.fitting.training import train

SIDE, LENGTH, PLATE, CHANNEL = 0.010, 0.050, 0.001, 0.002  # of the draft finger at the clamp [m]
TAPERS = {"thinner": 0.7, "thicker": 1.2}


def tapered(table: dict, taper: float, **changes: Any) -> FingerModel:
    table["geometry"]["taper"], table["mesh"]["cells"] = [taper], [14, 5]
    return FingerModel(Scene.model_validate(table | changes))


@pytest.fixture(params=["thinner", pytest.param("thicker", marks=pytest.mark.long)])
def model(request, table) -> tuple[FingerModel, float]:
    return tapered(table, TAPERS[request.param]), TAPERS[request.param]


@pytest.mark.long
def test_a_taper_of_one_is_none(table):
    plain = FingerModel(Scene.model_validate(table))
    table["geometry"]["taper"] = [1.0]
    one = FingerModel(Scene.model_validate(table))
    states = [model.solve([60.0, 40.0], 0.010, sensitivities=False) for model in (plain, one)]
    assert np.array_equal(states[0].displacement, states[1].displacement)


def test_its_volume_is_a_frustum_s_and_its_plate_s(model):
    finger, taper = model
    volume = finger.problem.scalar(fem.form(fem.Constant(finger.problem.mesh.mesh, 1.0) * ufl.dx))
    rubber = LENGTH - taper * PLATE
    expected = SIDE**2 * (rubber * (1 + taper + taper**2) / 3 + taper**3 * PLATE)
    assert volume == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("path", ["channel", pytest.param("straight", marks=pytest.mark.long)])
def test_a_tendon_s_length_under_a_homogeneous_deformation(table, path):
    """In a channel the mean of |F t| L, t its direction; of a straight one that of |x - F (0, Y, Z)| over its hole."""
    taper, F = 0.7, np.array([[1.2, 0.1, -0.2], [0.15, 0.9, 0.05], [0.1, -0.05, 1.1]])
    table["tendons"] = [tendon | {"path": path} for tendon in table["tendons"]]
    finger = tapered(table, taper)
    problem, rubber = finger.problem, LENGTH - taper * PLATE
    points = problem.space.tabulate_dof_coordinates()
    problem.displacement[:] = (points @ (F - np.eye(3)).T).ravel()

    def length(z: float, y: float) -> float:
        if path == "channel":
            return rubber * float(np.linalg.norm(F @ [1.0, (taper - 1) * y / rubber, (taper - 1) * z / rubber]))
        hole = np.array([LENGTH - taper * PLATE / 2, taper * y, taper * z])
        return float(np.linalg.norm(F @ hole - [0.0, y, z]))

    for k, tendon in enumerate(finger.scene.tendons):
        (low, high), (left, right) = ((at - CHANNEL / 2, at + CHANNEL / 2) for at in tendon.offset)
        mean = dblquad(length, low, high, left, right, epsabs=1e-14)[0] / CHANNEL**2
        assert problem.tendon_length(k) == pytest.approx(mean, rel=1e-6)


@pytest.mark.long
def test_reaction_and_contact_force_are_in_balance(model):
    finger, taper = model
    state = finger.solve([60.0 * taper**2, 40.0 * taper**2], 0.010, sensitivities=False)
    tolerance = 1e-10 * finger.problem.force_scale
    assert state.contact_force > 1.0
    assert state.clamp_reaction == pytest.approx([0.0, state.contact_force, 0.0], abs=tolerance)
    free = finger.solve([60.0 * taper**2, 40.0 * taper**2], sensitivities=False)
    assert np.abs(free.clamp_reaction).max() < tolerance


@pytest.mark.long
@pytest.mark.parametrize(
    ("path", "tensions", "d"),
    [("channel", [30.0, 20.0], 0.010), pytest.param("straight", [4.0, 2.0], 0.0015, marks=pytest.mark.long)],
)
def test_derivatives_are_those_of_the_potential_and_of_finite_differences(table, path, tensions, d):
    """dP/dF is a tendon's length and -dP/dd the contact force; sensitivities are differences of states."""
    table["tendons"] = [tendon | {"path": path} for tendon in table["tendons"]]
    finger, h = tapered(table, 0.7), (1e-2, 1e-6)
    state = finger.solve(tensions, d)
    assert state.contact_force > 0.05
    for k, name in enumerate(("F1", "F2", "d")):
        step = h[name == "d"]
        pulled = [tensions + sign * step * (np.arange(2) == k) for sign in (1, -1)]
        distances = [d + sign * step * (name == "d") for sign in (1, -1)]
        ahead, behind = (finger.solve(*at, sensitivities=False) for at in zip(pulled, distances, strict=True))

        def slope(quantity, ends=(ahead, behind), width=2 * step):
            return (np.asarray(quantity(ends[0])) - np.asarray(quantity(ends[1]))) / width

        conjugate = -state.contact_force if name == "d" else finger.problem.rest_lengths[k]
        conjugate -= 0.0 if name == "d" else state.channel_shortening[name]
        assert slope(lambda at: at.energy) == pytest.approx(conjugate, rel=1e-4)
        assert slope(lambda at: at.tip) == pytest.approx(state.sensitivities["tip"][name], rel=1e-3, abs=1e-8)
        shorter = slope(lambda at: list(at.channel_shortening.values()))
        of_tendons = list(state.sensitivities["channel_shortening"][name].values())
        assert shorter == pytest.approx(of_tendons, rel=1e-3, abs=1e-8)


@pytest.mark.long
def test_a_slender_tapered_bar_stretches_as_its_closed_form(table):
    """Between two sections, N l / (E A s1 s2) with their sizes s1 and s2: the integral of N / (E A s^2)."""
    taper, pull = 0.6, 0.05
    table["geometry"] |= {"segments": [0.2]}
    table["tendons"] = table["tendons"][:1]
    table.pop("obstacle")
    table["geometry"]["taper"], table["mesh"]["cells"] = [taper], [60, 5]
    finger = FingerModel(Scene.model_validate(table | {"load": {"force": 1.0}}))
    state = finger.solve([0.0], wrenches=np.array([[pull, 0, 0, 0, 0, 0]]), sensitivities=False)
    order = NodeOrder(finger.problem)
    sections = cross_sections(finger.scene, order.nodes)
    moved = sections.quantities(order.gather(state.displacement), np.zeros((0, len(order.nodes), 3)))["section_place"]
    first, last = np.searchsorted(sections.positions, [0.05, 0.15])
    begin, end = sections.positions[[first, last]]
    stretched = np.ptp(moved[[first, last], 0]) - (end - begin)
    sizes = finger.scene.geometry.size_at(np.array([begin, end]))
    modulus = finger.problem.law.young_modulus
    assert stretched == pytest.approx(pull * (end - begin) / (modulus * SIDE**2 * np.prod(sizes)), rel=2e-3)


@pytest.mark.parametrize(
    ("taper", "message"),
    [
        ([0.9, 0.9], r"taper must have one ratio per segment \(1\), got 2"),
        ([0.0], r"taper.0\n  Input should be greater than 0"),
        ([-0.5], r"taper.0\n  Input should be greater than 0"),
        ([60.0], r"plate must be shorter than every segment \(0.05 m\), got 0.06"),
        ([4.0], r"taper must change the side by at most 0.5 m per m of rubber, got 0.652"),
        ([0.1], r"must leave no cell of order 1 longer than two thirds of the side, 0.000827 m"),
    ],
)
def test_a_taper_that_makes_no_finger_is_refused(table, taper, message):
    table["geometry"]["taper"] = taper
    with pytest.raises(ValidationError, match=message):
        Scene.model_validate(table)


def test_a_scene_without_taper_has_the_fingerprint_that_it_had(table):
    scene = Scene.model_validate(table)
    assert "taper" not in scene.model_dump()["geometry"]
    table["geometry"]["taper"] = [0.9]
    assert Scene.model_validate(table).fingerprint() != scene.fingerprint()


@pytest.mark.parametrize(
    ("taper", "cells"), [pytest.param(*one, marks=pytest.mark.long) for one in ((0.9, 21), (0.6, 26))]
)
def test_a_rod_of_straight_elements_is_the_tapered_full_order_finger(demo, table, taper, cells):
    """On cells as long over their side as those of the training; the wrench's effect within 1 %, which covers both."""
    straight = Rod.load(demo / "finger.h5")
    tendons = [one | {"tension": [0.0, 100.0 * taper**2]} for one in table["tendons"]]
    geometry = table["geometry"] | {"taper": [taper]}
    rod = straight.assembled(table | {"geometry": geometry, "tendons": tendons})
    table.pop("obstacle")
    mesh = {"cells": [cells, 5], "order": 1}
    finger = FingerModel(Scene.model_validate(table | {"geometry": geometry, "load": {"force": 15.0}, "mesh": mesh}))
    tensions = taper**2 * np.array([60.0, 30.0])
    wrench = taper**3 * np.array([[-2.0, -6.0, 4.0, 0.0, 0.02, -0.01]])
    free, pressed = (finger.solve(tensions, wrenches=w, sensitivities=False) for w in (np.zeros((1, 6)), wrench))
    places = [rod.place(tensions, w) for w in (np.zeros((1, 6)), wrench)]
    off = [
        np.linalg.norm(at.centres[0] - one.plate_centres[0]) for at, one in zip(places, (free, pressed), strict=True)
    ]
    assert all(at.inside for at in places)
    assert off[0] < min(1e-3 * np.linalg.norm(free.tip), rod.errors.position)
    assert off[1] < 1e-2 * np.linalg.norm(pressed.tip - free.tip)
    shorter = list(free.channel_shortening.values())
    assert np.abs(rod.shortening(tensions) - shorter).max() < rod.errors.shortening


def test_elements_are_not_trained_on_a_tapered_finger():
    geometry = {"side": SIDE, "segments": [LENGTH], "plate": PLATE, "taper": [0.9]}
    with pytest.raises(SnapshotError, match=r"geometry\.taper must be left out to train elements"):
        train(SimpleNamespace(scene={"geometry": geometry}), {})


@pytest.mark.long
def test_a_bar_on_tapered_rubber_is_touched_and_pressed_as_in_the_full_order_model(demo, table):
    """The touch distance within 10 µm; the force within 5 %, as of a straight finger on this mesh."""
    taper, at, radius = 0.7, 0.036, 0.006
    place = {
        "centre": (at, 0.0043 + radius, 0.0),
        "direction": (0.0, 1.0, 0.0),
        "axis": (0.0, 0.0, 1.0),
        "radius": radius,
    }
    geometry = table["geometry"] | {"taper": [taper]}
    tendons = [one | {"tension": [0.0, 100.0 * taper**2]} for one in table["tendons"]]
    obstacle = {name: list(value) if isinstance(value, tuple) else value for name, value in place.items()}
    obstacle |= {"shape": "cylinder", "distance": [-0.004, 0.03]}
    own = {"geometry": geometry, "tendons": tendons, "mesh": {"cells": [24, 5], "order": 1}, "obstacle": obstacle}
    finger = FingerModel(Scene.model_validate(table | own))
    rod = Rod.load(demo / "finger.h5").assembled(table | own)
    model = TouchedSegment(rod=rod, obstacle=Cylinder(**place, distances=(-0.004, 0.03)))
    tensions, d = [14.7, 0.0], 0.005
    state, answer = finger.solve(tensions, d, sensitivities=False), model.evaluate([*tensions, d])
    assert answer.touch_distance == pytest.approx(state.touch_distance, abs=1e-5)
    assert state.contact_force > 0.2
    assert answer.contact_force == pytest.approx(state.contact_force, rel=0.05)
