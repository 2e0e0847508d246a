"""Cross-sections of pressed states: their derivatives, what each carries, and the tendons' shortening up to them."""

import tomllib
from typing import NamedTuple

import numpy as np
import pytest
from dolfinx import fem
from farm import ROOT
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from fingerfem import FingerModel
from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.forms import quadrature_degree
from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.discretisation.problem import Problem
from fingerfem.discretisation.volume_energies import Term, constants, residual_of, rubber_terms, volume_measure
from fingerfem.mechanics import strain_energy, tendons
from fingerfem.scene.laws import plate_law
from fingerfem.scene.scene import Scene
from fingerfem.snapshots.design import body, cross_sections
from fingerfem.snapshots.recorder import Recorder

ONE = {"order 1": ([9, 5], 1), "order 2": ([6, 5], 2)}
WRENCHES = np.array([[-0.6, -1.5, 0.8, 2e-3, -3e-3, 4e-3], [0.4, 0.3, -0.5, -1e-3, 2e-3, 1e-3]])  # [N, N m]
CORNERS = 5e-3 * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])  # y and z, in the order of section_corners [m]
SECTIONS = ("section_place", "section_rotation", "section_corners", "section_shortening")


class Pressed(NamedTuple):
    """A finger at an equilibrium under tensions [N] and wrenches on its plates, and what is stored of it."""

    finger: FingerModel
    tensions: np.ndarray
    wrenches: np.ndarray
    displacement: np.ndarray
    stored: dict[str, np.ndarray]

    def begin(self) -> Problem:
        """The finger's problem, brought back to this equilibrium."""
        self.finger.continuation.start(self.tensions, None, self.displacement, self.wrenches)
        return self.finger.problem


def scene(file: str, cells: list[int], order: int, **changes) -> Scene:
    """A finger that wrenches press on, on few cells."""
    table = tomllib.loads((ROOT / "scenes" / file).read_text())
    table.pop("obstacle", None)
    stored = {"store": ["channel_shortening"]}
    return Scene.model_validate(
        table | {"load": {"force": 5.0}, "mesh": {"cells": cells, "order": order}, "sampling": stored} | changes
    )


def solved(of: Scene, tensions: list[float], comm: MPI.Comm = MPI.COMM_SELF) -> Pressed:
    """That finger under tensions [N] and WRENCHES; what is stored is on the first rank alone."""
    finger, wrenches = FingerModel(of, comm), WRENCHES[: len(of.geometry.segments)]
    record = Recorder(finger, NodeOrder(finger.problem))
    finger.continuation.rest()
    record.state(np.array(tensions), None, wrenches=wrenches)
    arrays = record.arrays()
    assert all(arrays.get("converged", [True]))
    stored = {name: values[0] for name, values in arrays.items()}
    return Pressed(finger, np.array(tensions), wrenches, record.displacements[0], stored)


@pytest.fixture(
    scope="module",
    params=["order 1", *(pytest.param(one, marks=pytest.mark.long) for one in ("order 2", "two segments", "tapered"))],
)
def pressed(request) -> Pressed:
    if request.param == "two segments":
        return solved(scene("two_segments.toml", [9, 8], 1), [15.0, 10.0])
    if request.param == "tapered":
        geometry = {"side": 0.010, "segments": [0.050], "plate": 0.001, "taper": [0.7]}
        return solved(scene("pressed.toml", [14, 5], 1, geometry=geometry), [20.0, 12.0])
    return solved(scene("pressed.toml", *ONE[request.param]), [40.0, 25.0])


def inner_forces(problem: Problem) -> tuple[fem.Form, fem.Function]:
    """The internal forces of the cells that an indicator marks: the derivative of their energy, tendons included."""
    u, mesh, degree = problem.fields.u, problem.mesh, quadrature_degree(problem.scene.mesh.order)
    number, indicator = constants(mesh.mesh), fem.Function(problem.fields.tension_density.function_space)
    terms = [
        *rubber_terms(problem.scene.laws, number, degree),
        Term(strain_energy.energy(plate_law(problem.law), number), regions.PLATES, degree),
        Term(tendons.channelled(problem.fields.tension_density, problem.fields.size), regions.channels(1), degree),
    ]
    marked = [
        (lambda C, energy=term.energy: indicator * energy(C), volume_measure(mesh, degree)(term.regions))
        for term in terms
    ]
    return form_cache.form(residual_of(marked, u)), indicator


def test_a_section_carries_the_wrenches_on_the_plates_beyond_it_and_no_tension(pressed):
    finger, wrenches = pressed.finger, pressed.wrenches
    problem, plates = pressed.begin(), finger.scene.outline.plates
    rest = problem.space.tabulate_dof_coordinates()
    now, tolerance = rest + problem.displacement.reshape(-1, 3), finger.scene.outline.tolerance
    poses = problem.plates.poses(problem.displacement)
    outer = problem.plates.forces(poses, wrenches).reshape(-1, 3)
    form, indicator = inner_forces(problem)
    positions = body(finger.scene, NodeOrder(problem).nodes).sections
    for x, place in zip(positions[:-1], pressed.stored["section_place"], strict=False):  # nothing is beyond the last
        beyond = [k for k, (face, _) in enumerate(plates) if face > x - tolerance]
        indicator.x.array[:] = problem.mesh.midpoints[0] > x
        here = np.abs(rest[:, 0] - x) < tolerance
        # A plate's load is spread over its nodes, those of its near face included, where it is the section's own.
        own = outer[here] if any(abs(face - x) < tolerance for face, _ in plates) else 0.0
        forces = problem.nodal(form)[here] - own
        expected = [(poses[k].rotation @ wrenches[k, :3], poses[k].rotation @ wrenches[k, 3:], k) for k in beyond]
        force = sum((part for part, _, _ in expected), np.zeros(3))
        moment = sum((turn + np.cross(poses[k].centre - place, part) for part, turn, k in expected), np.zeros(3))
        scale = problem.force_scale
        assert forces.sum(axis=0) == pytest.approx(-force, abs=1e-10 * scale)
        about_section = np.cross(now[here] - place, forces).sum(axis=0)
        assert about_section == pytest.approx(-moment, abs=1e-10 * scale * finger.scene.geometry.length)


def near(pressed: Pressed, change: np.ndarray) -> dict[str, np.ndarray]:
    """Stored arrays of the state at changed parameters, shape (p,) [N, N m]."""
    record, count = Recorder(pressed.finger, NodeOrder(pressed.begin())), len(pressed.tensions)
    wrenches = pressed.wrenches + change[count:].reshape(pressed.wrenches.shape)
    record.state(pressed.tensions + change[:count], None, wrenches=wrenches)
    return {name: values[0] for name, values in record.arrays().items()}


def test_derivatives_are_those_of_states_that_are_solved_again(pressed):
    steps = np.full(len(pressed.stored["parameters"]), 1e-2)
    steps[len(pressed.tensions) :].reshape(-1, 6)[:, 3:] = 1e-4  # moments [N m]
    for k, h in enumerate(steps):
        before, after = (near(pressed, sign * h * np.eye(len(steps))[k]) for sign in (-1, 1))
        assert before["converged"] and after["converged"]
        for name in SECTIONS:
            slope = (after[name] - before[name]) / (2 * h)
            found = pressed.stored[f"{name}_jacobian"][..., k]
            assert found == pytest.approx(slope, abs=2e-5 * np.abs(slope).max()), name


def test_the_clamp_does_not_move_and_the_last_sections_are_the_plate(pressed):
    stored = pressed.stored
    for name in SECTIONS:
        rest = [1.0, 0, 0, 0] if name == "section_rotation" else 0.0
        assert stored[name][0] == pytest.approx(np.broadcast_to(rest, stored[name][0].shape), abs=1e-15), name
        assert np.abs(stored[f"{name}_jacobian"][0]).max() < 1e-15, name
    assert stored["section_rotation"][-1] == pytest.approx(stored["plate_rotation"][-1], abs=2e-4)  # steel yields
    centre = -Rotation.from_quat(stored["plate_rotation"][-1], scalar_first=True).apply(stored["clamp_place"][-1])
    between = stored["section_place"][-2:].mean(axis=0)  # of one cell
    assert np.linalg.norm(between - centre) < 1e-4 * pressed.finger.scene.geometry.side


def test_a_tendon_is_as_much_shorter_up_to_its_plate_as_in_all(pressed):
    stored, finger = pressed.stored, pressed.finger
    positions = body(finger.scene, NodeOrder(finger.problem).nodes).sections
    for k, tendon in enumerate(finger.scene.tendons):
        face = finger.scene.outline.plates[tendon.segment - 1][0]
        at_face = positions > face - finger.scene.outline.tolerance
        assert 2 <= at_face.sum() < len(positions)
        for suffix in ("", "_jacobian"):
            whole = stored[f"channel_shortening{suffix}"][k]
            own = stored[f"section_shortening{suffix}"][at_face, k]
            assert own == pytest.approx(np.broadcast_to(whole, own.shape), rel=1e-9, abs=1e-14)
        before = stored["section_shortening"][~at_face, k]
        assert np.abs(before - stored["channel_shortening"][k]).min() > 1e-7


@pytest.mark.parametrize(("cells", "order"), [ONE["order 1"], pytest.param(*ONE["order 2"], marks=pytest.mark.long)])
def test_the_sections_stored_are_those_of_the_displacement_stored(cells, order):
    of = scene("pressed.toml", cells, order, sampling={"store": ["displacement"]})
    pressed = solved(of, [40.0, 25.0])
    nodes, field = NodeOrder(pressed.finger.problem).nodes, pressed.stored["displacement"]
    found = cross_sections(of, nodes).quantities(field, np.zeros((1, *nodes.shape)))
    for name in SECTIONS[:3]:
        assert np.array_equal(found[name], pressed.stored[name]), name
    places = nodes + field
    corners = [places[np.linalg.norm(nodes - [0.05, *corner], axis=1).argmin()] for corner in CORNERS]
    turn = Rotation.from_quat(pressed.stored["section_rotation"][-1], scalar_first=True)
    seen = turn.inv().apply(corners - pressed.stored["section_place"][-1])
    at_rest = np.column_stack([np.zeros(4), CORNERS])
    assert pressed.stored["section_corners"][-1] == pytest.approx(seen - at_rest, abs=1e-15)


@pytest.mark.long
@pytest.mark.mpi
@pytest.mark.parametrize(("cells", "order"), ONE.values(), ids=ONE)
def test_ranks_that_share_a_finger_store_what_one_rank_does(cells, order):
    of = scene("pressed.toml", cells, order)
    alone, shared = (solved(of, [40.0, 25.0], comm).stored for comm in (MPI.COMM_SELF, MPI.COMM_WORLD))
    assert bool(shared) == (MPI.COMM_WORLD.rank == 0)
    for name in {*SECTIONS, *(f"{name}_jacobian" for name in SECTIONS)} & shared.keys():
        assert shared[name] == pytest.approx(alone[name], abs=1e-7 * np.abs(alone[name]).max()), name


@pytest.mark.long
def test_a_straight_tendon_passes_no_section_and_nothing_is_stored_of_it():
    table = tomllib.loads((ROOT / "scenes" / "pressed.toml").read_text())
    straight = [table["tendons"][0], table["tendons"][1] | {"path": "straight"}]
    stored = solved(scene("pressed.toml", [9, 5], 1, tendons=straight), [5.0, 1.0]).stored
    assert "section_shortening" not in stored and "section_shortening_jacobian" not in stored
    assert np.isfinite(stored["section_place_jacobian"]).all()
