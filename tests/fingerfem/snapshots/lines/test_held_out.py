"""Held-out states that begin at a training set's: the states from rest, in fewer iterations."""

import subprocess
import sys

import numpy as np
import pytest
from farm import ROOT, command, run

from fingerfem import FingerModel, load_scene
from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.snapshots.lines.held_out import HeldOutSolver
from fingerfem.snapshots.neighbours import KnownSet
from rom.dataset.snapshot_set import SnapshotSet

# A state is converged to a residual of 1e-9 E a^2, about 1e-6 N; a contact just touched is that much less sure of.
TOLERANCE = {"tip": 1e-8, "contact_force": 1e-4, "touch_distance": 1e-8, "displacement": 1e-8}  # [m], [N]


def assert_same_states(ours: SnapshotSet, theirs: SnapshotSet) -> None:
    assert np.array_equal(ours.random("parameters"), theirs.random("parameters"))
    for name, bound in TOLERANCE.items():
        assert np.abs(ours.random(name) - theirs.random(name)).max() < bound, name


@pytest.mark.long
def test_states_do_not_depend_on_where_they_began_and_take_fewer_iterations(scene, undisturbed, tmp_path):
    draw = "--random", "16", "--seed", "5"
    run(2, scene, tmp_path / "near", *draw, "--near", str(undisturbed))
    run(2, scene, tmp_path / "rest", *draw)
    near, rest = SnapshotSet(tmp_path / "near"), SnapshotSet(tmp_path / "rest")
    assert_same_states(near, rest)
    assert (rest.random("contact_force") > 0).sum() > 4
    assert not near.failures and near.iterations < rest.iterations  # of the demo's finer set a third


def test_states_of_the_demo_are_those_from_rest(trained):
    """A sample of the states that its report's errors are measured on."""
    held_out = SnapshotSet(trained / "heldout")
    model = FingerModel(load_scene(ROOT / "scenes" / "draft.toml"))
    felt = np.flatnonzero(held_out.random("contact_force") > 0)
    for k in [*felt[::8], *np.flatnonzero(held_out.random("contact_force") == 0)[::24]]:
        *tensions, distance = held_out.random("parameters")[k]
        state = model.solve(tensions, distance, sensitivities=False)
        assert np.abs(state.tip - held_out.random("tip")[k]).max() < TOLERANCE["tip"]
        assert abs(state.contact_force - held_out.random("contact_force")[k]) < TOLERANCE["contact_force"]


@pytest.mark.long
def test_where_a_neighbour_does_not_lead_there_it_goes_from_rest(scene, undisturbed, draft):
    """A neighbour that is no equilibrium: its displacement is of another state's, times ten."""
    model, snapshots = FingerModel(load_scene(scene)), SnapshotSet(undisturbed)
    numbering, near = NodeOrder(model.problem), KnownSet(undisturbed, snapshots.description)
    for kind in ("free", "contact"):
        near._fields[kind] = 10 * near._fields[kind]
    tensions, distances = np.array([70.0, 20.0]), [0.012, 0.006]
    arrays = HeldOutSolver(model, numbering, near).solve(tensions, distances).arrays()
    plain = HeldOutSolver(model, numbering).solve(tensions, distances).arrays()
    assert arrays["converged"].all()
    assert np.abs(arrays["contact_force"] - plain["contact_force"]).max() < TOLERANCE["contact_force"]
    assert arrays["iterations"].sum() > plain["iterations"].sum()  # what was tried in vain counts


def test_a_set_without_free_states_is_no_start_for_them(scene, undisturbed):
    model, snapshots = FingerModel(load_scene(scene)), SnapshotSet(undisturbed)
    numbering, near = NodeOrder(model.problem), KnownSet(undisturbed, snapshots.description)
    for kind in ("free", "contact"):
        near._points[kind], near._fields[kind] = near._points[kind][:0], near._fields[kind][:0]
    tensions, distances = np.array([70.0, 20.0]), [0.012, 0.006]
    arrays = HeldOutSolver(model, numbering, near).solve(tensions, distances).arrays()
    plain = HeldOutSolver(model, numbering).solve(tensions, distances).arrays()
    assert np.abs(arrays["contact_force"] - plain["contact_force"]).max() < TOLERANCE["contact_force"]


@pytest.mark.parametrize(
    "what",
    ["no set", "other scene", *(pytest.param(one, marks=pytest.mark.long) for one in ("held-out", "without random"))],
)
def test_a_set_that_none_can_begin_at_is_refused_in_one_line(what, scene, undisturbed, tmp_path):
    folder, options, file = undisturbed, ["--random", "2"], scene
    if what == "no set":
        folder = tmp_path / "nothing"
    elif what == "held-out":
        folder = tmp_path / "held-out"
        run(1, scene, folder, "--random", "1")
    elif what == "other scene":
        file = tmp_path / "other.toml"
        file.write_text(scene.read_text().replace("C1 = 1.9e6", "C1 = 1.8e6"))
    else:
        options = []
    line = command(1, file, tmp_path / "set", *options, "--near", str(folder))
    done = subprocess.run([sys.executable, *line[4:]], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1, done.stderr
    assert not (tmp_path / "set").exists()
