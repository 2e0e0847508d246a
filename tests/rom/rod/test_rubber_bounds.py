"""Bounds of gaps, by which far rubber is not searched for contacts: none that is near is lost."""

import numpy as np
import pytest

import rom
from rom import Plane, Sphere, TouchedSegment
from rom.rod.compiled.contacts import find_contacts
from rom.rod.rod import Rod

HALF = {"finger": 5e-3, "square": 1e-2}  # of the sides [m]
PULLED = {"finger": [60.0, 10.0], "square": [4.0, 1.0, 0.0, 0.0]}  # [N]
NEAR = 0.035  # of that: gaps that must be found; the search is for 0.04 [-]
DOME = 4e-6  # by which the search takes slices as domed, at their ends [m]


def before(rod: Rod, name: str, out: np.ndarray, at: float, radius: float) -> TouchedSegment:
    """A ball at the rubber, on the side `out` of a cross-section; a plane if the radius is infinite."""
    section = rod.sections(PULLED[name], at=[at * rod.rest[0]])
    out = section.rotations[0] @ out
    surface = section.centres[0] + HALF[name] * out
    where = {"direction": tuple(out), "distances": (-0.1, 0.1)}
    if np.isinf(radius):
        return TouchedSegment(rod=rod, obstacle=Plane(centre=tuple(surface), normal=tuple(-out), **where))
    return TouchedSegment(rod=rod, obstacle=Sphere(centre=tuple(surface + radius * out), radius=radius, **where))


@pytest.mark.parametrize("name", ["finger", "square"])
def test_an_object_that_touches_a_bulged_face_presses_at_any_depth(name):
    model = before(rom.load(name).rod, name, np.array([0.0, 1.0, 0.0]), 0.6, 1.5 * HALF[name])
    touch = float(model.evaluate([*PULLED[name], np.inf]).touch_distance)
    answers = [model.evaluate([*PULLED[name], touch - depth]) for depth in (2e-6, 5e-6, 2e-5, 5e-5, 1e-4)]
    assert all(one.inside for one in answers)
    forces = np.array([float(one.contact_force) for one in answers])
    assert (np.diff(forces, prepend=0.0) > 0).all()


@pytest.mark.parametrize("name", ["finger", "square"])
def test_the_nearest_contact_is_that_of_a_search_everywhere(name):
    random, rod, seen = np.random.default_rng(5), rom.load(name).rod, 0
    for _ in range(60):
        side, radius = random.uniform(0, 2 * np.pi), random.choice([0.7, 2.0, np.inf]) * HALF[name]
        model = before(rod, name, np.array([0.0, np.cos(side), np.sin(side)]), random.uniform(0.2, 0.9), radius)
        wrenches = np.zeros((len(rod.pieces[0]), 6))
        wrenches[0] = random.uniform(-1, 1, 6) * [0.2, 0.2, 0.2, 1e-3, 4e-3, 4e-3]
        tensions, wanted, d = (
            random.uniform(0.2, 1.0) * np.array(PULLED[name]),
            random.uniform(0.0, NEAR) * HALF[name],
            0.0,
        )
        for _ in range(4):  # to the wanted gap
            d += wanted - model.rubber_gap([*tensions, d], wrenches)
        gap = model.rubber_gap([*tensions, d], wrenches)
        contacts = find_contacts(model.touching, tensions, d, np.zeros(3), wrenches)
        if not 0.0 <= gap < NEAR * HALF[name]:
            continue
        seen += 1
        nearest = contacts.gaps[contacts.rubber.astype(bool)].min(initial=np.inf)
        assert nearest < gap + DOME
    assert seen > 30
