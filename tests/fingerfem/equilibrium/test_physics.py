"""Options of a scene beyond the draft: contact methods, laws, near incompressibility, straight tendons, symmetry."""

import tomllib
from contextlib import nullcontext
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI
from unoptimised import unoptimised

from fingerfem import FingerModel, load_scene
from fingerfem.discretisation import forms, regions
from fingerfem.mechanics import strain_energy
from fingerfem.output.cell_fields import cell_fields, contact_pressure
from fingerfem.scene.laws import STEEL, neo_hookean_from
from fingerfem.scene.scene import Scene
from fingerfem.snapshots.design import describe
from fingerfem.snapshots.lines.solver import LineSolver
from fingerfem.versions import versions

SCENES = Path(__file__).resolve().parents[3] / "scenes"


@pytest.fixture
def planar(table) -> dict:
    """The draft finger with the tendon F1 alone."""
    table["tendons"] = table["tendons"][:1]
    return table


def model_of(table: dict) -> FingerModel:
    return FingerModel(Scene.model_validate(table))


# -- contact --

CONTACT = [([50.0, 20.0], 0.005), ([100.0, 0.0], 0.020), ([60.0, 40.0], 0.010)]


STIFFNESS = {"penalty": 2000.0, "nitsche": 1000.0}


@cache
def forces(method: str, factor: float) -> list[float]:
    """Contact force [N] in three states by a method at some factor of its own stiffness."""
    scene = load_scene(SCENES / "draft.toml").model_dump()
    scene["mesh"]["cells"] = [10, 5]
    scene["obstacle"] |= {"method": method, "stiffness": factor * STIFFNESS[method]}
    with unoptimised() if method == "nitsche" else nullcontext():
        model = model_of(scene)
    return [model.solve(*load, sensitivities=False).contact_force for load in CONTACT]


@pytest.mark.long
@pytest.mark.parametrize(
    ("method", "factor"),
    [
        ("penalty", 10.0),
        ("nitsche", 1.0),
        *(
            pytest.param(*one, marks=pytest.mark.long)
            for one in (("penalty", 0.1), ("nitsche", 0.1), ("nitsche", 10.0))
        ),
    ],
)
def test_contact_force_depends_on_neither_method_nor_stiffness(method, factor):
    """Within 0.1 % between the methods and under a tenfold change of either's stiffness."""
    assert forces(method, factor) == pytest.approx(forces("penalty", 1.0), rel=1e-3)


@pytest.mark.long
def test_nitsche_keeps_the_identities_of_the_potential(table):
    table["obstacle"]["method"], table["mesh"]["cells"] = "nitsche", [10, 5]
    with unoptimised():
        model = model_of(table)
    tensions, d, h = [60.0, 40.0], 0.010, 1e-5
    state = model.solve(tensions, d)
    assert state.clamp_reaction == pytest.approx([0.0, state.contact_force, 0.0], abs=1e-7)
    ahead, behind = (model.solve(tensions, d + step, sensitivities=False).energy for step in (h, -h))
    assert -(ahead - behind) / (2 * h) == pytest.approx(state.contact_force, rel=1e-3)


def test_complementarity_is_reported_and_nearly_kept(draft):
    state = draft.solve([50.0, 20.0], 0.005, sensitivities=False)
    assert 0 < state.penetration < 1e-4 * 0.010
    assert 0 < state.complementarity < 1e-3
    free = draft.solve([50.0, 20.0], sensitivities=False)
    assert free.penetration is None and free.contact_force == 0.0


def test_nodal_contact_pressure_sums_up_to_the_contact_force(draft):
    state = draft.solve([60.0, 40.0], 0.010, sensitivities=False)
    draft.take(state)
    pressure = contact_pressure(draft)
    assert pressure.min() == 0.0
    ds = forms.surface_measure(draft.scene, draft.problem.mesh)
    shares = draft.problem.nodal(fem.form(ufl.TestFunction(draft.problem.space)[1] * ds(regions.SURFACE)))[:, 1]
    assert pressure @ shares == pytest.approx(state.contact_force, rel=1e-9)
    touched = draft.problem.space.tabulate_dof_coordinates()[pressure > 0]
    assert np.all(touched[:, 1] > 0.005 - 1e-9) and np.all(touched[:, 0] > 0.049 - 1e-9)


def test_a_file_for_paraview_holds_the_state(draft, tmp_path):
    import pyvista

    from fingerfem.output.paraview import write_vtu

    state = draft.solve([60.0, 40.0], 0.010, sensitivities=False)
    write_vtu(draft, state, tmp_path / "state.vtu")
    grid = pyvista.read(tmp_path / "state.vtu")
    assert grid.n_points * 3 == state.unknowns
    assert (grid.points + grid.point_data["displacement"])[:, 1].max() == pytest.approx(0.015, abs=1e-6)
    assert set(grid.cell_data) == {"S11", "von_mises", "J", "region", "material"}
    assert state.smallest_volume_ratio < np.nanmin(grid.cell_data["J"]) < 1.0  # corners see more than midpoints
    with pytest.raises(ValueError, match=r"must end in \.vtu"):
        write_vtu(draft, state, tmp_path / "state.vtk")


# -- what a scene does not name costs nothing --


@pytest.mark.long
@pytest.mark.parametrize("load", [([100.0], None), pytest.param(([50.0], 0.005), marks=pytest.mark.long)], ids=str)
def test_half_a_finger_gives_the_answer_of_the_whole(planar, load):
    half = model_of(planar).solve(*load)
    planar["mesh"]["symmetry"] = False
    whole = model_of(planar).solve(*load)
    assert half.unknowns < 0.6 * whole.unknowns
    assert half.tip == pytest.approx(whole.tip, abs=1e-8 * 0.05)
    for name in ("contact_force", "energy", "touch_distance"):
        assert getattr(half, name) == pytest.approx(getattr(whole, name), rel=1e-8)
    assert half.clamp_reaction == pytest.approx(whole.clamp_reaction, abs=1e-8)
    for quantity, by in whole.sensitivities.items():
        for parameter in by:
            assert half.sensitivities[quantity][parameter] == pytest.approx(by[parameter], rel=1e-6, abs=1e-8)


# -- laws --


@pytest.mark.long
def test_laws_agree_where_strains_are_small(planar):
    """The same small-strain moduli, a pull that bends the tip by some hundredths of its length."""
    neo = load_scene(SCENES / "draft.toml").law
    E, nu = neo.young_modulus, neo.poisson
    C01 = 0.2 * neo.shear_modulus / 2
    tables = [
        planar["material"],
        {"law": "saint-venant-kirchhoff", "E": E, "nu": nu},
        {
            "law": "mooney-rivlin",
            "C10": neo.shear_modulus / 2 - C01,
            "C01": C01,
            "D1": 2 / (neo.bulk_modulus - 16 / 3 * C01),
        },
    ]
    planar["mesh"]["cells"] = [10, 5]
    with unoptimised():
        models = [model_of(planar | {"material": material}) for material in tables]
    tips = [model.solve([0.5], sensitivities=False).tip[1] for model in models]
    assert tips[1] == pytest.approx(tips[0], rel=0.01)
    assert tips[2] == pytest.approx(tips[0], rel=0.01)


@pytest.mark.long
def test_rubber_with_a_negative_mooney_rivlin_constant_bends(planar):
    """A published fit of silicone, nearly incompressible and so mixed, on two meshes."""
    planar["geometry"] |= {"side": 0.020, "segments": [0.100], "plate": 0.002}
    planar["material"] = {"law": "mooney-rivlin", "C10": 10.6e3, "C01": -4.2e3, "D1": 3e-6}
    planar["tendons"][0]["offset"] = [0.008, 0.0]
    tips = []
    for cells in ([20, 5], [30, 7]):
        planar["mesh"]["cells"] = cells
        with unoptimised():
            state = model_of(planar).solve([0.5])
        assert state.stable
        tips.append(state.tip[1])
    assert tips[0] == pytest.approx(tips[1], rel=0.02) and tips[0] > 0.03


def incompressible(poisson: float, **settings) -> dict:
    law = neo_hookean_from(9.88e6, poisson)
    return {"law": "neo-hookean", "C1": law.C1, "D1": law.D1, **settings}


@pytest.mark.long
def test_rubber_of_poissons_ratio_04999_bends_and_does_not_lock(planar):
    """A fixed E bends alike at every Poisson's ratio; displacements alone would lock at a fifth of that."""
    planar["mesh"]["cells"] = [16, 5]
    tips = {
        poisson: model_of(planar | {"material": incompressible(poisson)}).solve([30.0], sensitivities=False).tip[1]
        for poisson in (0.3, 0.499, 0.4999)
    }
    assert tips[0.4999] == pytest.approx(tips[0.499], rel=0.002)
    assert tips[0.4999] == pytest.approx(tips[0.3], rel=0.03)
    locked = model_of(planar | {"material": incompressible(0.4999, formulation="displacement")})
    assert locked.solve([30.0], sensitivities=False).tip[1] < 0.5 * tips[0.4999]


def test_the_eliminated_pressure_is_the_unknown_of_a_saddle_point(planar):
    """The same state solves the mixed equations with an explicit pressure per cell, p (J - 1) - p^2 D1 / 4."""
    planar["material"], planar["mesh"]["cells"] = incompressible(0.4999), [10, 4]
    model = model_of(planar)
    model.solve([20.0], sensitivities=False)
    mesh, u, law = model.problem.mesh.mesh, model.problem.fields.u, model.problem.law
    space = fem.functionspace(mesh, ("DG", 0))
    p, q, v = fem.Function(space), ufl.TestFunction(space), ufl.TestFunction(model.problem.space)
    C = ufl.variable((ufl.Identity(3) + ufl.grad(u)).T * (ufl.Identity(3) + ufl.grad(u)))
    J = ufl.sqrt(ufl.det(C))
    one_point = ufl.dx(mesh, metadata={"quadrature_degree": 1})
    # The pressure's own equation, cell by cell, gives p; with it the displacements' must be in equilibrium.
    constraint = fem.assemble_vector(fem.form((J - 1) * q * one_point)).array
    volume = fem.assemble_vector(fem.form(q * one_point)).array
    rubber = np.isin(model.problem.mesh.cells.values, regions.of_material(0))
    p.x.array[model.problem.mesh.cells.indices] = np.where(rubber, 2 * constraint / volume / law.D1, 0.0)
    # With it, the rubber's other part, the plates' and the tendon's forces must be those of the model.
    distortional, _ = strain_energy.parts(law)
    dx = ufl.Measure("dx", mesh, subdomain_data=model.problem.mesh.cells, metadata={"quadrature_degree": 2})
    body = distortional(C) * dx(regions.of_material(0)) + strain_energy.energy(STEEL)(C) * dx(regions.PLATES)
    pressure = fem.assemble_vector(fem.form(ufl.derivative(p * J * one_point, u, v))).array
    explicit = pressure + fem.assemble_vector(fem.form(ufl.derivative(body, u, v))).array
    explicit += fem.assemble_vector(model.problem.forms.actuator_force).array
    ours = fem.assemble_vector(model.problem.forms.residual).array
    assert np.abs(explicit - ours).max() < 1e-9 * np.abs(pressure).max()
    assert np.abs(pressure).max() > 1.0  # the pressure does bear on the answer


# -- tendons --


@pytest.mark.long
def test_a_straight_tendon_bends_more_than_a_guided_one_and_pulls_on_the_clamp(planar):
    """Its lever grows as the finger bends away from it, and the clamp's hole is outside the finger: the reaction is
    what the cable pulls there."""
    guided = model_of(planar).solve([20.0], sensitivities=False)
    planar["tendons"][0]["path"] = "straight"
    straight = model_of(planar).solve([20.0])
    assert straight.tip[1] > 1.5 * guided.tip[1]
    assert np.linalg.norm(straight.clamp_reaction) == pytest.approx(20.0, rel=0.01)
    h = 0.01
    model = model_of(planar)
    ahead, behind = (model.solve([20.0 + step], sensitivities=False) for step in (h, -h))
    length = model.problem.rest_lengths[0] - straight.channel_shortening["F1"]
    assert (ahead.energy - behind.energy) / (2 * h) == pytest.approx(length, rel=1e-5)
    slope = (ahead.tip - behind.tip) / (2 * h)
    assert straight.sensitivities["tip"]["F1"] == pytest.approx(slope, rel=1e-3)


@pytest.mark.long
def test_guided_and_straight_tendons_can_be_mixed(table):
    table["tendons"][1]["path"] = "straight"
    state = model_of(table).solve([30.0, 5.0], sensitivities=False)
    assert state.tip[1] > 0.005 and state.tip[2] > 0.001


@pytest.mark.long
def test_the_long_tendon_slides_through_the_middle_plate():
    model = FingerModel(load_scene(SCENES / "two_segments.toml"))
    short, long = (model.solve(tensions) for tensions in ([30.0, 0.0], [0.0, 30.0]))
    assert model.problem.rest_lengths == pytest.approx([0.049, 0.099])
    # The short one bends the first segment alone, the long one both.
    x, stress = model.problem.mesh.midpoints[0], []
    for state in (short, long):
        model.take(state)
        S11 = abs(cell_fields(model)["S11"])
        stress.append([np.nanmax(S11[(x > a) & (x < b)]) for a, b in ((0.01, 0.04), (0.06, 0.09))])
    assert stress[0][1] < 0.02 * stress[0][0]
    assert stress[1][1] == pytest.approx(stress[1][0], rel=0.05)
    assert long.clamp_reaction == pytest.approx(0, abs=1e-9)
    # Maxwell: what one shortens the other's channel.
    assert short.sensitivities["channel_shortening"]["F_l"]["F_s"] == pytest.approx(
        short.sensitivities["channel_shortening"]["F_s"]["F_l"], rel=1e-6
    )


def test_tendons_of_two_plates_share_a_channel():
    table = tomllib.loads((SCENES / "two_segments.toml").read_text())
    del table["obstacle"]
    table |= {"mesh": {"cells": [10, 7]}, "load": {"force": 1.0}}
    short, long = (one | {"offset": [0.004, 0.0]} for one in table["tendons"])
    one, other, both = (model_of(table | {"tendons": tendons}) for tendons in ([short], [long], [short, long]))
    assert both.problem.rest_lengths == pytest.approx([0.049, 0.099])
    assert both.solve([0.0, 20.0]).tip == pytest.approx(other.solve([20.0]).tip, rel=1e-9)
    alone, shared = both.solve([20.0, 0.0]), both.solve([10.0, 10.0])
    assert alone.tip == pytest.approx(one.solve([20.0]).tip, rel=1e-9)
    # Both pull on the first segment with their sum: it turns as by one tendon of that tension.
    turns = [np.arctan2(state.plate_rotations[0][1, 0], state.plate_rotations[0][0, 0]) for state in (alone, shared)]
    assert turns[0] == pytest.approx(turns[1], rel=0.02)
    shortened = shared.sensitivities["channel_shortening"]
    assert shortened["F_s"]["F_l"] == pytest.approx(shortened["F_l"]["F_s"], rel=1e-6)


# -- what the model does not prevent --


@pytest.mark.long
def test_a_finger_that_curls_into_itself_is_marked(planar):
    """In its plane a finger that turns by more than a circle, F e L / EI > 2 pi, meets itself."""
    planar["geometry"]["segments"], planar["mesh"]["cells"] = [0.120], [48, 5]
    planar["tendons"][0]["tension"] = [0.0, 150.0]
    del planar["obstacle"]
    model = model_of(planar)
    assert not model.solve([60.0], sensitivities=False).self_intersecting
    assert model.solve([150.0], sensitivities=False).self_intersecting


@pytest.mark.long
def test_a_finger_that_curls_into_itself_is_a_failed_snapshot(planar, tmp_path):
    planar["geometry"]["segments"], planar["mesh"]["cells"] = [0.120], [48, 5]
    planar["tendons"][0]["tension"] = [0.0, 150.0]
    planar["sampling"] = {"tension_nodes": 4}
    del planar["obstacle"]
    model = model_of(planar)
    line = LineSolver(describe(model.scene, versions()), model, tmp_path).solve("free-0")
    assert line["parameters"][[0, -1], 0] == pytest.approx([0, 150])
    assert line["converged"][0] and not line["converged"][-1]
    assert line["reason"][-1] == "the finger passes through itself"
    assert np.isnan(line["displacement"][-1]).all() and np.isnan(line["tip"][-1]).all()


@pytest.mark.long
@pytest.mark.parametrize(
    ("scene", "tensions"),
    [
        ("draft", [100.0, 100.0]),
        ("draft", [100.0, 0.0]),
        ("four_tendons", [30.0] * 4),
        ("two_segments", [40.0, 40.0]),
    ],
)
def test_shipped_scenes_stay_clear_of_themselves(scene, tensions):
    assert not FingerModel(load_scene(SCENES / f"{scene}.toml")).solve(tensions, sensitivities=False).self_intersecting


@pytest.mark.long
def test_two_opposite_tendons_shorten_a_finger_and_leave_it_stable(planar):
    planar["tendons"].append(planar["tendons"][0] | {"name": "F3", "offset": [-0.004, 0.0]})
    state = model_of(planar).solve([60.0, 60.0])
    assert state.stable
    assert state.tip[1] == pytest.approx(0, abs=1e-8)
    assert state.tip[0] < -0.003


@pytest.mark.long
def test_more_ranks_than_cells_along_an_edge_do_not_change_the_answer(planar):
    """Ranks may be left without a cell of a region, of the clamp or of the plane's side."""
    if MPI.COMM_WORLD.size > 1:
        pytest.skip("starts ranks of its own")
    import json
    import subprocess
    import sys

    command = [sys.executable, "-m", "fingerfem", "solve", "scenes/draft.toml", "F1=40", "F2=10", "d=0.005", "--json"]
    run = {"cwd": SCENES.parent, "capture_output": True, "text": True, "check": True}
    alone = json.loads(subprocess.run(command, **run).stdout)
    shared = json.loads(subprocess.run(["mpirun", "-n", "6", *command], **run).stdout)
    assert shared["tip"] == pytest.approx(alone["tip"], abs=1e-9 * 0.05)
    assert shared["contact_force"] == pytest.approx(alone["contact_force"], rel=1e-9)
    assert shared["self_intersecting"] == alone["self_intersecting"]


# -- stability --


@pytest.mark.long
def test_half_a_finger_reports_when_the_whole_one_falls_to_the_side(planar):
    """A plane props the tip in y; across, a straight tendon on the axis makes it a column clamped at one end."""
    planar["tendons"][0]["tension"] = [0.0, 100.0]
    planar["tendons"].append(planar["tendons"][0] | {"name": "F2", "path": "straight", "offset": [0.0, 0.0]})
    planar["obstacle"] = {"distance": [0.001, 0.031], "method": "penalty"}
    for axial, stable in ((20.0, True), (60.0, False)):
        for symmetry in (True, False):
            planar["mesh"]["symmetry"] = symmetry
            model = model_of(planar)
            for tensions, distance in (([5.0, 0.0], None), ([5.0, 0.0], 0.001), ([5.0, axial], 0.001)):
                model.continuation.advance(tensions, distance)
            linearisation = model.continuation.linearise()
            assert linearisation.stable is stable
            assert linearisation.negative_pivots == (0 if stable or symmetry else 1)


def test_an_unstable_equilibrium_is_a_failed_snapshot(planar, tmp_path):
    planar["tendons"] = [planar["tendons"][0] | {"path": "straight", "offset": [0.0, 0.0], "tension": [0.0, 60.0]}]
    planar["sampling"] = {"tension_nodes": 4}
    del planar["obstacle"]
    model = model_of(planar)
    line = LineSolver(describe(model.scene, versions()), model, tmp_path).solve("free-0")
    assert line["parameters"][:, 0] == pytest.approx([0, 20, 40, 60])
    assert line["converged"].tolist() == [True, True, False, False]  # Euler's load is some 33 N
    assert line["reason"][-1] == "the equilibrium is not stable"


@pytest.mark.long
def test_saint_venant_kirchhoff_rubber_is_taken_up_to_its_limit(planar):
    planar["material"] = {"law": "saint-venant-kirchhoff", "E": 9.88e6, "nu": 0.45}
    assert model_of(planar).solve([5.0]).stable
