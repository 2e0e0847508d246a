"""Pressure chambers: Lame's tube, balance of forces, the potential and its derivatives, directions and volumes."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import ufl
from dolfinx import fem
from gmsh_files import write_mesh
from mpi4py import MPI
from scipy.optimize import brentq

from fingerfem import FingerModel, load_scene
from fingerfem.discretisation import regions
from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.friction_history import friction_history
from fingerfem.full_order_plant import FullOrderPlant
from fingerfem.mechanics.kinematics import cofactor, deformation_gradient
from fingerfem.scene.grid_lines import section_mesh
from fingerfem.scene.scene import Scene
from tests.fingerfem.scene.test_chambers import CHAMBER as LOW
from tests.fingerfem.scene.test_chambers import F1
from tests.fingerfem.scene.test_chambers import TABLE as SQUARE

SCENES = Path(__file__).resolve().parents[3] / "scenes"
HIGH = LOW | {"name": "p2", "centre": [0.0045, 0.0]}


def model(**changes: Any) -> FingerModel:
    return FingerModel(Scene.model_validate(SQUARE | changes))


@pytest.fixture(scope="module")
def one() -> FingerModel:
    return model()


@pytest.fixture(scope="module")
def two() -> FingerModel:
    return model(chambers=[LOW, HIGH])


E, NU, PRESSURE, INNER, OUTER = 1e6, 0.3, 100.0, 0.005, 0.010


def lame(r: float) -> float:
    """Radial displacement of a thick tube with closed ends [m]: axial stress p a^2 / (b^2 - a^2)."""
    stress = PRESSURE * INNER**2 / (OUTER**2 - INNER**2)
    return stress / E * ((1 - 2 * NU) * r + (1 + NU) * OUTER**2 / r)


def tube_errors(cells: list[int], order: int) -> list[float]:
    """Relative errors of the radial displacement at mid-length, of the bore and of the outside."""
    tube = model(
        section={"shape": "ring", "diameter": 2 * OUTER, "bore": 2 * INNER},
        geometry={"segments": [0.080], "plate": 0.002, "channel": 0.003},
        material={"law": "saint-venant-kirchhoff", "E": E, "nu": NU},
        tendons=[F1 | {"offset": [0.0075, 0.0]}],
        chambers=[{"name": "p1", "region": "bore", "x": [0.005, 0.075], "pressure": [0.0, 1e3]}],
        mesh={"cells": cells, "order": order},
    )
    state = tube.solve([0.0, PRESSURE], sensitivities=False)
    points, moved = tube.problem.space.tabulate_dof_coordinates(), state.displacement.reshape(-1, 3)
    radii, along = np.hypot(points[:, 1], points[:, 2]), np.abs(points[:, 0] - 0.040)
    middle, errors = along < along.min() + 1e-8, []
    wall = fem.locate_dofs_topological(tube.problem.space, 2, tube.problem.mesh.facets.find(regions.WALL))
    for nodes, radius in ((np.isin(np.arange(len(points)), wall), INNER), (radii > 0.9999 * radii.max(), OUTER)):
        own = middle & nodes
        outwards = np.sum(points[own, 1:] * moved[own, 1:], axis=1) / radii[own]
        errors.append(abs(outwards.mean() / lame(radius) - 1))
    return errors


def test_a_thick_tube_widens_as_lame_s_with_closed_ends_and_the_better_the_finer():
    coarse, middle, fine = (tube_errors(*mesh) for mesh in (([12, 5], 1), ([20, 12], 1), ([10, 5], 2)))
    assert max(middle) < 0.02 and max(fine) < 0.005
    assert coarse > middle > fine


@pytest.mark.parametrize("order", [1, 2])
def test_pressure_in_a_closed_chamber_has_no_resultant(order):
    state = model(mesh={"cells": [10, 7], "order": order}).solve([0.0, 1.5e4], sensitivities=False)
    assert np.linalg.norm(state.tip) > 3e-4
    assert state.clamp_reaction == pytest.approx([0.0, 0.0, 0.0], abs=1e-7 * 1.5e4 * 0.005 * 0.008)


def test_a_chamber_that_ends_at_the_clamp_and_the_plate_pulls_on_the_clamp_with_its_area():
    finger = model(chambers=[LOW | {"x": [0.0, 0.058]}])
    state = finger.solve([0.0, 1e4])
    assert finger.problem.rest_volumes == pytest.approx([0.005 * 0.008 * 0.058], rel=1e-12)
    assert state.clamp_reaction == pytest.approx([-1e4 * 0.005 * 0.008, 0.0, 0.0], abs=1e-9)
    assert state.stable and state.chamber_volumes["p1"] > finger.problem.rest_volumes[0]


@pytest.mark.parametrize("loads", [[0.0, 1e4], [5.0, 1.5e4]])
def test_the_potential_falls_with_pressure_by_the_volume_gained(one, loads):
    """dP/dp = -(V - V0): Hellmann and Feynman."""
    step, potentials = 100.0, []
    for change in (-step, step):
        potentials.append(one.solve([loads[0], loads[1] + change], sensitivities=False).energy)
    gained = one.solve(loads, sensitivities=False).chamber_volumes["p1"] - one.problem.rest_volumes[0]
    assert gained > 1e-8
    assert np.diff(potentials)[0] / (2 * step) == pytest.approx(-gained, rel=1e-5)


@pytest.mark.parametrize(
    "changes", [{}, {"mesh": {"cells": [10, 7], "order": 2, "symmetry": False}}], ids=["half", "whole"]
)
def test_the_tangent_is_symmetric_and_the_residual_s_derivative(changes):
    problem = Problem(Scene.model_validate(SQUARE | {"chambers": [LOW, HIGH]} | changes), MPI.COMM_SELF)
    draw, step = np.random.default_rng(1), 1e-7
    start, change = (draw.standard_normal(problem.displacement.size) for _ in range(2))
    rubber = np.repeat(problem.space.tabulate_dof_coordinates()[:, 0] < 0.0579, 3)  # steel hides what presses there
    rubber[problem.held] = False
    start, change, residuals = start * rubber, change * rubber, []
    problem.set_loads([0.0, 1e7, 2e7], None)  # large, so that the pressures' part counts
    for side in (-1, 1):
        problem.displacement[:] = 2e-5 * start + side * step * change
        b, _ = problem.residual()
        residuals.append(b.array_r.copy())
        b.destroy()
    problem.displacement[:] = 2e-5 * start
    problem.extrapolate_stress()
    matrix = problem.tangent()
    expected = np.diff(residuals, axis=0)[0] / (2 * step)
    b = matrix.createVecRight()
    b.array[:] = change
    found = (matrix * b).array_r.copy()
    assert found[rubber] == pytest.approx(expected[rubber], abs=1e-6 * np.abs(expected[rubber]).max())
    transposed = matrix.copy()
    transposed.transpose()
    assert (matrix - transposed).norm() < 1e-12 * matrix.norm()
    problem.set_loads([0.0, 0.0, 0.0], None)
    without = (problem.tangent() * b).array_r
    assert np.abs(found - without)[rubber].max() > 0.1 * np.abs(expected[rubber]).max()


@pytest.mark.parametrize("x", [[0.004, 0.054], [0.0, 0.058]], ids=["in the rubber", "from clamp to plate"])
def test_the_potential_s_forces_are_those_of_pressure_on_the_wall(x):
    """The integral of p cof(F) N . v, also where the clamp, a plate or the cut closes the chamber."""
    problem = Problem(Scene.model_validate(SQUARE | {"chambers": [LOW | {"x": x}]}), MPI.COMM_SELF)
    moved = 1e-4 * np.random.default_rng(2).standard_normal(problem.displacement.size)
    moved[problem.held] = 0.0
    problem.displacement[:] = moved
    wall = ufl.Measure("ds", problem.mesh.mesh, subdomain_data=problem.mesh.facets, metadata={"quadrature_degree": 4})
    v, normal = ufl.TestFunction(problem.space), ufl.FacetNormal(problem.mesh.mesh)
    push = ufl.inner(cofactor(deformation_gradient(problem.fields.u)) * normal, v)
    expected = problem.nodal(fem.form(push * wall(regions.WALL))).ravel()
    problem.actuators.probe([0.0, 1.0])
    found = problem.nodal(problem.forms.actuator_force).ravel()
    free = np.ones((expected.size // 3, 3), bool)
    free[problem.space.tabulate_dof_coordinates()[:, 2] < 1e-9, 2] = (
        False  # across the cut its mirror image balances it
    )
    free = free.ravel()
    assert np.abs(expected).max() > 1e-6
    assert found[free] == pytest.approx(expected[free], abs=1e-12 * np.abs(expected).max())


@pytest.mark.long
def test_a_thin_tube_of_neo_hookean_rubber_has_no_equilibrium_beyond_its_limit():
    """A membrane with closed ends: p = s T / (R l^2 m), where the hoop stress s is twice the axial one."""
    radius, wall, mu = 0.009, 0.002, 1e5
    tube = model(
        section={"shape": "ring", "diameter": 0.020, "bore": 0.016},
        geometry={"segments": [0.080], "plate": 0.002, "channel": 0.0015},
        material={"law": "neo-hookean", "C1": mu / 2, "D1": 2e-7},
        tendons=[F1 | {"offset": [0.009, 0.0]}],
        chambers=[{"name": "p1", "region": "bore", "x": [0.004, 0.074], "pressure": [0.0, 1e5]}],
        mesh={"cells": [20, 8]},
    )
    with pytest.raises(LoadNotReached, match=r"beyond tensions \[0.0\] N, pressures \[\d+.\d+\] Pa") as failure:
        tube.solve([0.0, 3e4])

    def stress(stretch: float, other: float) -> float:
        return mu * (stretch**2 - (stretch * other) ** -2.0)

    def pressure(hoop: float) -> float:
        axial = brentq(lambda m: stress(m, hoop) - stress(hoop, m) / 2, 0.5, 3.0)
        return stress(hoop, axial) * wall / (radius * hoop**2 * axial)

    limit = max(map(pressure, np.linspace(1.01, 3.0, 400)))
    assert failure.value.tensions[1] == pytest.approx(limit, rel=0.1)


def test_a_chamber_bends_the_finger_away_from_it_and_its_mirror_image_by_the_same():
    low, high = (model(tendons=[F1 | {"offset": [0.0, 0.0]}], chambers=[each]) for each in (LOW, HIGH))
    tips = [finger.solve([0.0, 1e4], sensitivities=False).tip for finger in (low, high)]
    assert tips[0][1] > 2e-4
    assert tips[1] == pytest.approx(tips[0] * [1, -1, 1], abs=1e-10)


def test_a_chamber_aside_bends_the_finger_aside_as_one_below_bends_it_up():
    """The finger is then modelled whole."""
    table = {"tendons": [F1 | {"offset": [0.0, 0.0]}], "mesh": {"cells": [10, 11], "symmetry": False}}
    aside = LOW | {"centre": LOW["centre"][::-1], "size": LOW["size"][::-1]}
    up, side = (model(**table, chambers=[each]) for each in (LOW, aside))
    half = model(**table | {"mesh": {"cells": [10, 11]}})
    assert half.scene.is_half and not Scene.model_validate(SQUARE | table | {"chambers": [aside]}).is_half
    tip = half.solve([0.0, 1e4], sensitivities=False).tip
    assert up.solve([0.0, 1e4], sensitivities=False).tip == pytest.approx(tip, rel=1e-7, abs=1e-9)
    assert side.solve([0.0, 1e4], sensitivities=False).tip[2] == pytest.approx(tip[1], rel=0.05)


def test_equal_pressures_in_two_equal_chambers_only_lengthen_the_finger(two):
    balanced = model(tendons=[F1 | {"offset": [0.0, 0.0]}], chambers=[LOW, HIGH])
    tip = balanced.solve([0.0, 1e4, 1e4], sensitivities=False).tip
    assert tip[0] > 2e-5 and abs(tip[1]) < 1e-10 and abs(tip[2]) < 1e-10
    assert two.solve([0.0, 1e4, 1e4], sensitivities=False).tip[0] > 2e-5


def test_sensitivities_by_pressure_are_differences_of_states_and_symmetric(two):
    loads, step = np.array([3.0, 8e3, 5e3]), 1.0
    state = two.solve(loads)
    found = state.sensitivities
    for k, name in enumerate(("p1", "p2"), start=1):
        ends = [two.solve(loads + side * step * np.eye(3)[k], sensitivities=False) for side in (-1, 1)]
        for quantity in ("channel_shortening", "chamber_volumes"):
            values = [getattr(end, quantity) for end in ends]
            for own, derivative in found[quantity][name].items():
                assert derivative == pytest.approx((values[1][own] - values[0][own]) / (2 * step), rel=1e-3)
        assert found["tip"][name] == pytest.approx((ends[1].tip - ends[0].tip) / (2 * step), rel=1e-3, abs=1e-14)
    volumes, shortening = found["chamber_volumes"], found["channel_shortening"]
    assert volumes["p1"]["p2"] == pytest.approx(volumes["p2"]["p1"], rel=1e-8)
    assert volumes["F1"]["p1"] == pytest.approx(shortening["p1"]["F1"], rel=1e-8)
    assert state.stable


def test_the_order_in_which_a_tendon_and_a_pressure_come_does_not_matter(one):
    goal, states = [10.0, 1.5e4], []
    for first in ([10.0, 0.0], [0.0, 1.5e4]):
        one.continuation.rest()
        for loads in (first, goal):
            one.continuation.advance(loads, None)
        states.append(one.problem.displacement.copy())
    assert np.abs(states[0]).max() > 1e-2
    assert np.abs(states[1] - states[0]).max() < 1e-8 * np.abs(states[0]).max()


def test_a_group_of_a_file_is_the_same_chamber(one, tmp_path):
    mesh = section_mesh(one.scene.outline, 7)
    file = write_mesh(tmp_path / "section.msh", mesh, {0: "channel F1", -2: "chamber p1"})
    group = {key: value for key, value in LOW.items() if key not in ("centre", "size")} | {"region": "group"}
    geometry = {"segments": [0.060], "plate": 0.002}
    same = model(section={"file": str(file)}, geometry=geometry, chambers=[group], mesh={"cells": [10, 1]})
    states = [finger.solve([2.0, 1e4], sensitivities=False) for finger in (one, same)]
    assert states[1].tip == pytest.approx(states[0].tip, rel=1e-9, abs=1e-12)
    assert states[1].chamber_volumes == pytest.approx(states[0].chamber_volumes, rel=1e-9)


def test_chambers_of_two_segments_may_share_their_region():
    """The bore of a tapered ring: each chamber works on its own segment."""
    bores = [
        {"name": f"p{k}", "region": "bore", "x": x, "pressure": [0.0, 2e4]}
        for k, x in enumerate(([0.004, 0.034], [0.044, 0.074]))
    ]
    ring = model(
        section={"shape": "ring", "diameter": 0.020, "bore": 0.008},
        geometry={"segments": [0.040, 0.040], "plate": 0.002, "taper": [0.9, 0.8]},
        tendons=[F1 | {"offset": [0.0075, 0.0], "segment": 2}],
        chambers=bores,
        mesh={"cells": [8, 5]},
    )
    state = ring.solve([0.0, 1e4, 5e3])
    volumes = state.sensitivities["chamber_volumes"]
    assert volumes["p0"]["p1"] == pytest.approx(volumes["p1"]["p0"], abs=1e-6 * volumes["p0"]["p0"])
    assert abs(volumes["p0"]["p1"]) < 0.05 * volumes["p1"]["p1"]
    assert state.clamp_reaction == pytest.approx([0.0, 0.0, 0.0], abs=1e-8)
    assert ring.problem.rest_volumes[1] < 0.85 * ring.problem.rest_volumes[0]


def test_a_pressed_finger_pushes_the_harder_the_higher_the_pressure():
    finger = model(obstacle={"distance": [0.0001, 0.02]})
    state = finger.solve([0.0, 1.5e4], 0.0002)
    step = [finger.solve([0.0, 1.5e4 + change], 0.0002, sensitivities=False).contact_force for change in (-10.0, 10.0)]
    assert state.contact_force > 0.01
    assert state.sensitivities["contact_force"]["p1"] == pytest.approx((step[1] - step[0]) / 20.0, rel=0.02)
    assert FullOrderPlant(finger, 0.0002).pull([0.0, 1.5e4]) == pytest.approx(state.contact_force, rel=1e-6)
    history = friction_history(finger, [[0.0, 1e4, 0.0002], [0.0, 1.5e4, 0.0002]], 0.0, increments=2)
    assert history[1].normal_force == pytest.approx(state.contact_force, rel=1e-3)


@pytest.mark.mpi
def test_ranks_that_share_a_finger_share_its_chambers():
    scene, loads = Scene.model_validate(SQUARE | {"chambers": [LOW, HIGH]}), [2.0, 1.5e4, 5e3]
    shared, alone = (FingerModel(scene, comm).solve(loads) for comm in (MPI.COMM_WORLD, MPI.COMM_SELF))
    assert shared.tip == pytest.approx(alone.tip, rel=1e-8, abs=1e-12)
    assert shared.chamber_volumes == pytest.approx(alone.chamber_volumes, rel=1e-10)
    for name, derivatives in alone.sensitivities["chamber_volumes"].items():
        assert shared.sensitivities["chamber_volumes"][name] == pytest.approx(derivatives, rel=1e-6)


def test_a_wall_that_passes_through_the_other_one_is_noticed(one):
    one.continuation.rest()
    assert not one.passes_through_itself()
    points, moved = one.problem.space.tabulate_dof_coordinates(), one.problem.displacement.reshape(-1, 3)
    upper = (np.abs(points[:, 1] + 0.002) < 1e-9) & (points[:, 2] < 0.003) & (np.abs(points[:, 0] - 0.030) < 0.015)
    moved[upper, 1] = -0.0052  # the chamber is 0.005 m high
    assert upper.sum() > 4 and one.passes_through_itself()
    one.continuation.rest()


def test_the_finger_of_two_chambers_bends_both_ways():
    finger = FingerModel(load_scene(SCENES / "two_chambers.toml"))
    up, down = (finger.solve([0.0, *pressures], sensitivities=False) for pressures in ([6e4, 0.0], [0.0, 6e4]))
    assert up.tip[1] > 8e-3
    assert down.tip == pytest.approx(up.tip * [1, -1, 1], abs=1e-8)


@pytest.mark.parametrize("loads", [[0.0, -1.0], [0.0, 3e4], [0.0]])
def test_pressures_that_a_scene_does_not_allow_are_refused(one, loads):
    with pytest.raises(ValueError, match=r"p1 must lie in \[0, 20000\] Pa|tensions must be 2 values in N, pressures"):
        one.check_loads(loads, None)
