"""Fingers of any section: bending by closed forms, the same states by other meshes, contact, and what is refused."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gmsh_files import write_mesh
from mpi4py import MPI
from pydantic import ValidationError
from scipy.spatial import cKDTree

from fingerfem import FingerModel, load_scene
from fingerfem.discretisation import regions
from fingerfem.discretisation.mesh import build_mesh
from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.scene.grid_lines import section_mesh
from fingerfem.scene.scene import Scene

SCENES = Path(__file__).resolve().parents[2] / "scenes"
NEO_HOOKEAN = {"law": "neo-hookean", "C1": 1.0e5, "D1": 2e-6}
CIRCLE: dict[str, Any] = {"shape": "circle", "diameter": 0.020}
RING: dict[str, Any] = {"shape": "ring", "diameter": 0.020, "bore": 0.006}
SQUARE: dict[str, Any] = {"shape": "square", "side": 0.010 * math.sqrt(math.pi)}  # as large as the circle
SECTIONS = {"circle": CIRCLE, "ring": RING}
FOUR = [[0.0065, 0.0], [0.0, 0.0065], [-0.0065, 0.0], [0.0, -0.0065]]


def table(section: dict, offsets=FOUR, cells=(14, 5), **changes: Any) -> dict:
    """A finger of 60 mm with a tendon at every offset."""
    tendons = [
        {"name": f"F{k}", "offset": list(offset), "segment": 1, "tension": [0.0, 60.0]}
        for k, offset in enumerate(offsets)
    ]
    return {
        "name": "finger",
        "section": section,
        "geometry": {"segments": [0.06], "plate": 0.002, "channel": 0.003},
        "material": NEO_HOOKEAN,
        "tendons": tendons,
        "mesh": {"cells": list(cells)},
    } | changes


def model(section: dict, *given: Any, **changes: Any) -> FingerModel:
    return FingerModel(Scene.model_validate(table(section, *given, **changes)))


@pytest.mark.mpi
@pytest.mark.parametrize("section", SECTIONS.values(), ids=SECTIONS)
def test_regions_have_the_volumes_and_areas_of_the_section(section):
    from dolfinx import fem
    from ufl import Measure

    scene = Scene.model_validate(table(section))
    finger = build_mesh(scene, MPI.COMM_WORLD)
    one = fem.Constant(finger.mesh, 1.0)
    dx = Measure("dx", finger.mesh, subdomain_data=finger.cells)
    ds = Measure("ds", finger.mesh, subdomain_data=finger.facets)

    def size(measure):
        return MPI.COMM_WORLD.allreduce(fem.assemble_scalar(fem.form(one * measure)))

    area, mesh = scene.geometry.shape.area, finger.section
    channels = sum(mesh.column_area(k) for k in range(4))
    around = np.linalg.norm(np.diff(mesh.points[mesh.border], axis=1), axis=2).sum()
    assert size(dx) == pytest.approx(0.06 * area, rel=1e-12)
    assert size(dx(regions.TIP)) == pytest.approx(0.002 * area, rel=1e-12)
    assert size(dx(regions.RUBBER_CHANNEL)) == pytest.approx(0.058 * channels, rel=1e-12)
    assert size(ds(regions.CLAMP)) == pytest.approx(area, rel=1e-12)
    assert size(ds(regions.SURFACE)) == pytest.approx(0.06 * around + area, rel=1e-12)


LENGTH, PLATE, YOUNG = 0.100, 0.001, 1e7
BARS = {
    "square": ({"shape": "square", "side": 0.005}, 5 / 6),
    "circle": ({"shape": "circle", "diameter": 0.005}, 6 / 7),
    "ring": ({"shape": "ring", "diameter": 0.005, "bore": 0.002}, None),
}


def bar(section: dict, offset: float, **changes: Any) -> FingerModel:
    """A slender bar of Saint Venant and Kirchhoff's law, nu = 0, half of it by symmetry."""
    material = {"law": "saint-venant-kirchhoff", "E": YOUNG, "nu": 0.0}
    geometry = {"segments": [LENGTH], "plate": PLATE, "channel": 0.0007}
    mesh = {"cells": [24, 6], "order": 2}
    return model(section, [[offset, 0.0]], material=material, geometry=geometry, mesh=mesh, **changes)


@pytest.mark.parametrize("name", BARS)
def test_a_tendon_s_couple_bends_a_bar_by_its_second_moment_of_area(name):
    section, _ = BARS[name]
    finger, offset, tension = bar(section, 0.0017), 0.0017, 1e-5
    state = finger.solve([tension], sensitivities=False)
    rubber, stiffness = LENGTH - PLATE, YOUNG * finger.scene.geometry.shape.second_moment
    turn = tension * offset * rubber / stiffness
    assert state.tip[1] == pytest.approx(turn * (rubber + PLATE) / 2, rel=5e-3)
    assert state.tip[0] == pytest.approx(-tension * rubber / (YOUNG * finger.scene.geometry.shape.area), rel=1e-2)


@pytest.mark.parametrize("name", BARS)
def test_weight_bends_a_bar_as_timoshenko_s_beam(name):
    """w = q L^4 / 8 E I + q L^2 / 2 k G A, Cowper's k at nu = 0."""
    section, factor = BARS[name]
    if factor is None:
        m = section["bore"] / section["diameter"]
        factor = 6 * (1 + m**2) ** 2 / (7 * (1 + m**2) ** 2 + 20 * m**2)
    gravity = {"density": 10.0, "plate_density": 0.0, "direction": [0.0, -1.0, 0.0], "acceleration": 0.1}
    finger = bar(section, 0.0017, gravity=gravity)
    shape, rubber = finger.scene.geometry.shape, LENGTH - PLATE
    load, stiffness = 10.0 * 0.1 * shape.area, YOUNG * shape.second_moment
    bent = load * rubber**4 / 8 / stiffness + load * rubber**3 / 6 / stiffness * PLATE / 2
    sheared = load * rubber**2 / 2 / (factor * YOUNG / 2 * shape.area)
    state = finger.solve([0.0], sensitivities=False)
    assert -state.tip[1] == pytest.approx(bent + sheared, rel=5e-3)


def test_a_square_from_a_file_has_the_states_of_a_side(tmp_path):
    """The square's own grid, written as a file and read again; nodes have another order."""
    side = Scene.model_validate(table(SQUARE, cells=(14, 7)))
    assert side.model_dump()["geometry"]["side"] == SQUARE["side"] and "section" not in side.model_dump()
    names = {column.tag: f"channel {column.name}" for column in side.outline.columns}
    file = write_mesh(tmp_path / "square.msh", section_mesh(side.outline, 7), names)
    geometry = {"segments": [0.06], "plate": 0.002}
    read = table({"file": str(file)}, geometry=geometry, mesh={"cells": [14, 1]})
    models = [FingerModel(side), FingerModel(Scene.model_validate(read))]
    states = [one.solve([3.0, 1.0, 0.0, 0.0], sensitivities=False) for one in models]
    fields = [NodeOrder(one.problem).gather(state.displacement) for one, state in zip(models, states, strict=True)]
    assert fields[0] == pytest.approx(fields[1], abs=1e-9 * np.abs(fields[0]).max())
    assert np.abs(fields[0]).max() > 1e-3


def test_a_square_table_is_the_side_itself():
    plain = table(SQUARE, cells=(14, 7))
    del plain["section"]
    plain["geometry"]["side"] = SQUARE["side"]
    assert Scene.model_validate(plain).fingerprint() == Scene.model_validate(table(SQUARE, cells=(14, 7))).fingerprint()


def turned(vectors: np.ndarray) -> np.ndarray:
    """About x, by which y becomes z."""
    return np.asarray(vectors)[..., [0, 2, 1]] * [1.0, -1.0, 1.0]


def test_a_rectangle_turned_by_a_right_angle_has_the_turned_state():
    offsets = np.array([[0.004, 0.0], [0.0, 0.0025], [-0.003, -0.001]])
    measures = {"geometry": {"segments": [0.05], "plate": 0.001, "channel": 0.0016}, "mesh": {"cells": [12, 11]}}
    upright = model({"shape": "rectangle", "height": 0.012, "width": 0.008}, offsets.tolist(), **measures)
    around = (offsets[:, ::-1] * [-1.0, 1.0]).tolist()
    lying = model({"shape": "rectangle", "height": 0.008, "width": 0.012}, around, **measures)
    states = [one.solve([1.0, 0.5, 0.3], sensitivities=False) for one in (upright, lying)]
    orders = [NodeOrder(one.problem) for one in (upright, lying)]
    fields = [order.gather(state.displacement) for order, state in zip(orders, states, strict=True)]
    away, same = cKDTree(orders[1].nodes).query(turned(orders[0].nodes))
    assert away.max() < 1e-12
    assert fields[1][same] == pytest.approx(turned(fields[0]), abs=1e-9 * np.abs(fields[0]).max())


@pytest.mark.parametrize("name", SECTIONS)
def test_half_a_finger_has_the_state_of_the_whole(name):
    two = [[0.0065, 0.0], [-0.0065, 0.0]]
    half = model(SECTIONS[name], two, obstacle={"distance": [0.001, 0.03]})
    whole = model(SECTIONS[name], two, mesh={"cells": [14, 5], "symmetry": False}, obstacle={"distance": [0.001, 0.03]})
    states = [one.solve([2.5, 0.2], 0.004, sensitivities=False) for one in (half, whole)]
    assert half.scene.is_half and not whole.scene.is_half and states[0].contact_force > 0.05
    assert states[0].tip == pytest.approx(states[1].tip, abs=1e-9 * np.abs(states[1].tip).max())
    assert states[0].contact_force == pytest.approx(states[1].contact_force, rel=1e-8)
    assert not states[0].self_intersecting


BESIDE = {"shape": "plane", "centre": [0.0, 0.0, 0.01], "normal": [0.0, 0.0, -1.0], "direction": [0.0, 0.0, 1.0]}


@pytest.mark.parametrize("name", SECTIONS)
def test_contact_is_in_balance_and_alike_on_planes_that_the_section_s_symmetry_carries_into_each_other(name):
    """The mesh is its own image by a right angle, and so is the finger."""
    above = model(SECTIONS[name], obstacle={"distance": [0.001, 0.03]})
    beside = model(SECTIONS[name], obstacle=BESIDE | {"distance": [0.001, 0.03]})
    states = [above.solve([2.5, 0.0, 0.0, 0.0], 0.004), beside.solve([0.0, 2.5, 0.0, 0.0], 0.004)]
    scale = above.problem.force_scale
    for state, direction in zip(states, np.eye(3)[1:], strict=True):
        assert state.contact_force > 0.05
        assert state.clamp_reaction == pytest.approx(state.contact_force * direction, abs=1e-10 * scale)
    assert states[0].contact_force == pytest.approx(states[1].contact_force, rel=1e-8)
    assert turned(states[0].tip) == pytest.approx(states[1].tip, abs=1e-9)


def test_a_circle_takes_about_as_many_iterations_as_a_square_of_its_area():
    """At the same loads, free and in contact; measured 11 and 11 (free 4 and 5, pressed 7 and 6)."""
    taken = []
    for section, cells in ((CIRCLE, (14, 5)), (SQUARE, (14, 7))):
        finger = model(section, cells=cells, obstacle={"distance": [0.001, 0.03]})
        tensions = [2.5, 0.0, 0.0, 0.0]
        taken.append(sum(finger.solve(tensions, d, sensitivities=False).newton_iterations for d in (None, 0.004)))
    assert abs(taken[0] - taken[1]) <= 4


def test_a_straight_tendon_runs_in_a_circle_s_hole_and_a_taper_scales_the_section():
    tapered = {"segments": [0.06], "plate": 0.002, "channel": 0.003, "taper": [0.8]}
    finger = model(CIRCLE, [[0.0065, 0.0]], geometry=tapered)
    size = finger.scene.geometry.size_at(np.array([0.0, 0.06]))
    assert size.tolist() == [1.0, 0.8]
    points = finger.problem.space.tabulate_dof_coordinates()
    end = points[points[:, 0] > 0.0599]
    assert np.hypot(*end[:, 1:].T).max() == pytest.approx(0.8 * np.hypot(*points[:, 1:].T).max(), rel=1e-9)
    straight = table(CIRCLE, [[0.0065, 0.0]])
    straight["tendons"][0]["path"] = "straight"
    state = FingerModel(Scene.model_validate(straight)).solve([1.0])
    assert state.tip[1] > 1e-3
    assert np.linalg.norm(state.clamp_reaction) == pytest.approx(1.0, rel=1e-3)  # the tendon pulls on the plate alone


@pytest.mark.mpi
def test_the_round_silicone_finger_bends_towards_the_tendon_that_is_pulled():
    finger = FingerModel(load_scene(SCENES / "round.toml"), MPI.COMM_WORLD)
    up = finger.solve([0.5, 0.0, 0.0, 0.0])
    right = finger.solve([0.0, 0.5, 0.0, 0.0], sensitivities=False)
    assert up.tip[1] > 1e-3 and abs(up.tip[2]) < 1e-9
    assert right.tip == pytest.approx(turned(up.tip), abs=1e-8)
    assert np.abs(up.clamp_reaction).max() < 1e-8 * finger.problem.force_scale
    assert up.smallest_volume_ratio == pytest.approx(1.0, abs=2e-3)


REFUSED = {
    "side beside a section": (
        {"geometry": {"side": 0.01, "segments": [0.06], "plate": 0.002}},
        "side must be left out",
    ),
    "pad": (
        {"obstacle": {"distance": [0.001, 0.03], "pad": {"name": "tip", "x": [0.05, 0.06]}}},
        "obstacle.pad must be left out of a scene with a circle section: a pad lies on the flat face",
    ),
    "preset": ({"preset": "draft"}, r"preset must be left out with \[section\]: .* give mesh.cells, got 'draft'"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_a_round_finger_cannot_do_yet_is_refused_when_its_scene_is_read(case):
    changes, rule = REFUSED[case]
    whole = table(CIRCLE) | changes
    if case == "preset":
        del whole["mesh"]
    with pytest.raises(ValidationError, match=rule):
        Scene.model_validate(whole)


@pytest.mark.parametrize(
    ("section", "offset", "rule"),
    [
        (CIRCLE, [0.009, 0.0], r"tendons.0.offset must keep its channel inside the section \(at most 0.0085 m"),
        (CIRCLE, [0.002, 0.0], r"must be on the axis or at least the channel's width, 0.003 m, from it, got \[0.002"),
        (RING, [0.0, 0.0], r"must keep its channel or hole outside the bore \(at least 0.0045 m from the axis\)"),
        (
            RING | {"bore": 0.0199},
            [0.007, 0.0],
            "bore must be at most 0.0192 m, to leave a wall of at least 0.02 diameters, got 0.0199",
        ),
        ({"shape": "oval", "diameter": 0.02}, [0.007, 0.0], "shape must be 'square' or 'rectangle' or 'circle' or"),
        ({"diameter": 0.02}, [0.007, 0.0], "shape is required and missing"),
        (CIRCLE | {"bore": 0.01}, [0.007, 0.0], "bore\n  Extra inputs are not permitted"),
    ],
)
def test_sections_and_offsets_that_do_not_fit_are_refused(section, offset, rule):
    with pytest.raises(ValidationError, match=rule):
        Scene.model_validate(table(section, [offset]))
