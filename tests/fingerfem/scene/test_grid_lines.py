"""Grid lines fit plates and channels at every resolution."""

import tomllib
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpi4py import MPI

from fingerfem.discretisation import regions
from fingerfem.discretisation.mesh import build_mesh
from fingerfem.scene import grid_lines
from fingerfem.scene.scene import Scene

SCENES = Path(__file__).resolve().parents[3] / "scenes"


def lines_of(scene: Scene):
    wanted = scene.outline.wanted(scene.mesh.cells[1], scene.is_half, scene.mesh.order)
    return grid_lines.lines_along(scene.outline, scene.mesh), *scene.geometry.shape.lines(wanted)


@given(st.lists(st.floats(0.01, 10.0), min_size=1, max_size=8), st.integers(0, 60))
def test_a_subdivision_holds_every_breakpoint_and_has_the_cells_asked_for(lengths, extra):
    breakpoints = np.concatenate([[0.0], np.cumsum(lengths)])
    lines = grid_lines.subdivide(breakpoints, len(lengths) + extra)
    assert len(lines) == len(lengths) + extra + 1
    assert np.all(np.diff(lines) > 0)
    assert all(np.abs(lines - point).min() < 1e-12 * breakpoints[-1] for point in breakpoints)


def test_an_odd_number_of_cells_without_a_central_one_is_refused():
    with pytest.raises(ValueError, match="even to stay symmetric"):
        grid_lines.subdivide([-1.0, 0.0, 1.0], 3, symmetric=True)


@pytest.mark.parametrize("cells", [5, 6, 7, 8, 9, 10, 15, 20])
def test_the_section_is_symmetric_at_every_resolution(cells):
    lines = grid_lines.subdivide([-5.0, -3.0, -1.0, 1.0, 3.0, 5.0], cells, symmetric=True)
    assert np.allclose(lines, -lines[::-1], atol=1e-12)


def test_the_papers_grid_is_uniform(table):
    table["mesh"]["cells"] = [100, 10]
    x, y, z = lines_of(Scene.model_validate(table))
    assert np.allclose(np.diff(x), 0.5e-3, rtol=1e-9)
    assert np.allclose(np.diff(y), 1e-3, rtol=1e-9)
    assert np.array_equal(y, z)


@given(st.lists(st.floats(0.012, 0.2), min_size=2, max_size=8))
def test_cells_of_all_segments_are_nearly_as_long_as_those_of_the_longest(lengths):
    table = tomllib.loads((SCENES / "two_segments.toml").read_text())
    table["geometry"]["segments"], table["tendons"] = lengths, table["tendons"][:1]
    del table["obstacle"]
    table["mesh"] = {"cells": [round(max(lengths) / 2e-3), 8]}
    scene = Scene.model_validate(table)
    x, _, _ = lines_of(scene)
    ends = np.append(0.0, np.cumsum(lengths))
    counts = [np.sum((x > begin + 1e-9) & (x < end + 1e-9)) for begin, end in pairwise(ends)]
    assert counts[int(np.argmax(lengths))] == table["mesh"]["cells"][0]
    more = np.array(counts) - np.array(lengths) / max(lengths) * max(counts)
    assert more.min() > -1e-4 and more.max() < 1


@pytest.mark.mpi
@pytest.mark.parametrize("cells", [[10, 5], [23, 8], [40, 10]])
def test_regions_have_the_volumes_and_areas_of_the_finger_at_every_resolution(table, cells):
    from dolfinx import fem
    from ufl import Measure

    table["mesh"]["cells"] = cells
    finger = build_mesh(Scene.model_validate(table), MPI.COMM_WORLD)
    one = fem.Constant(finger.mesh, 1.0)
    dx = Measure("dx", finger.mesh, subdomain_data=finger.cells)
    ds = Measure("ds", finger.mesh, subdomain_data=finger.facets)

    def size(measure):
        return MPI.COMM_WORLD.allreduce(fem.assemble_scalar(fem.form(one * measure)))

    assert size(dx(regions.TIP)) == pytest.approx(1e-3 * 1e-4, rel=1e-12)
    assert size(dx(regions.RUBBER_CHANNEL)) == pytest.approx(2 * 49e-3 * 4e-6, rel=1e-12)
    assert size(dx) == pytest.approx(50e-3 * 1e-4, rel=1e-12)
    assert size(ds(regions.CLAMP)) == pytest.approx(1e-4, rel=1e-12)
    assert size(ds(regions.PAD)) == pytest.approx(1e-5, rel=1e-12)
    assert size(ds(regions.SURFACE)) == pytest.approx(4 * 50e-5 + 1e-4, rel=1e-12)


@pytest.mark.parametrize("across", [5, 6, 9])
def test_half_a_finger_is_half_of_the_whole_on_the_same_lines(table, across):
    table["tendons"] = table["tendons"][:1]
    table["mesh"]["cells"][1] = across
    half = lines_of(Scene.model_validate(table))
    table["mesh"]["symmetry"] = False
    whole = lines_of(Scene.model_validate(table))
    assert np.array_equal(half[0], whole[0]) and np.array_equal(half[1], whole[1])
    assert half[2][0] == 0.0
    assert np.allclose(whole[2], np.concatenate([-half[2][:0:-1], half[2]]), atol=1e-15)


def test_the_pad_is_the_patch_that_the_scene_names(table):
    from dolfinx import fem
    from ufl import Measure

    table["mesh"]["cells"] = [20, 8]
    table["obstacle"]["pad"] = {"name": "belly", "x": [0.031, 0.0475], "width": 0.005}
    finger = build_mesh(Scene.model_validate(table), MPI.COMM_SELF)
    ds = Measure("ds", finger.mesh, subdomain_data=finger.facets)
    area = fem.assemble_scalar(fem.form(fem.Constant(finger.mesh, 1.0) * ds(regions.PAD)))
    assert area == pytest.approx(0.0165 * 0.005, rel=1e-12)


def test_a_channel_that_ends_on_the_axis_has_a_grid_line_there(table):
    table["tendons"] = table["tendons"][:1]
    table["tendons"][0]["offset"] = [0.001, 0.0]
    table["mesh"]["cells"] = [20, 6]
    scene = Scene.model_validate(table)
    _, y, _ = lines_of(scene)
    middles = (y[1:] + y[:-1]) / 2
    inside = np.abs(middles - 0.001) < 0.001
    assert np.abs(y).min() < 1e-15 and np.diff(y)[inside].sum() == pytest.approx(0.002, rel=1e-9)
    table["mesh"]["cells"] = [20, 5]
    with pytest.raises(ValueError, match="even to stay symmetric"):
        Scene.model_validate(table)


def test_a_pad_that_ends_beside_a_plate_is_refused_for_the_sliver_it_would_leave(table):
    table["obstacle"]["pad"]["x"] = [0.040, 0.049001]
    with pytest.raises(ValueError, match=r"mesh.cells\[0\] must leave no cell shorter than 1/1000 of the side"):
        Scene.model_validate(table)
    table["obstacle"]["pad"]["x"] = [0.040, 0.049 + 1e-12]  # equal up to round-off
    x, _, _ = lines_of(Scene.model_validate(table))
    assert np.diff(x).min() > 1e-4


@pytest.mark.parametrize("scene", ["draft", "free", "four_tendons"])
def test_a_swept_grid_is_a_box_of_hexahedra_numbered_as_dolfinx_numbers_them(scene):
    import dolfinx

    one = Scene.model_validate(tomllib.loads((SCENES / f"{scene}.toml").read_text()))
    lines = lines_of(one)
    counts = [len(along) - 1 for along in lines]
    kind, ghosts = dolfinx.mesh.CellType.hexahedron, dolfinx.mesh.GhostMode.none
    box = dolfinx.mesh.create_box(MPI.COMM_SELF, [np.zeros(3), np.ones(3)], counts, kind, ghost_mode=ghosts)
    for axis, along in enumerate(lines):
        box.geometry.x[:, axis] = along[np.rint(box.geometry.x[:, axis] * counts[axis]).astype(int)]
    finger = build_mesh(one, MPI.COMM_SELF)
    assert finger.has_boxes
    assert np.array_equal(finger.mesh.geometry.dofmap, box.geometry.dofmap)
    assert np.array_equal(finger.mesh.geometry.x, box.geometry.x)
