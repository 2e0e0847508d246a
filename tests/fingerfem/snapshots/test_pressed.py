"""Sets of pressed states: what is drawn, the same numbers whoever solves them, and the finger that comes of it."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from farm import ROOT, run
from terminal import ran

from fingerfem import FingerModel, load_scene
from fingerfem.scene.scene import SceneError
from fingerfem.snapshots import wrenches
from fingerfem.snapshots.design import HeldOut, describe
from fingerfem.snapshots.lines.solver import LineSolver
from rom import Rod, TouchedSegment
from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.samples.section_states import read_section_states
from rom.rod.objects.shapes import facing_plane

FORCE = 4.0


@pytest.fixture(scope="module")
def pressed_scene(tmp_path_factory) -> Path:
    """The draft finger on few cells, that something may press on instead of a plane."""
    text = (ROOT / "scenes" / "draft.toml").read_text()
    head, rest = text.split("[obstacle]")
    mesh = rest[rest.index("[mesh]") :].split("[sampling]")[0].replace("cells = [20, 5]", "cells = [10, 5]")
    file = tmp_path_factory.mktemp("pressed") / "pressed.toml"
    load = f"[load]\nforce = {FORCE}\nfriction_angle = 0.2\n\n"
    file.write_text(
        f'{head}{load}{mesh}[sampling]\nlines = 15\nwrenches = 3\nstore = ["displacement", "channel_shortening"]\n'
    )
    return file


@pytest.fixture(scope="module")
def pressed_set(pressed_scene, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("pressed-set") / "set"
    report = run(2, pressed_scene, folder)
    assert report["states"] == 60 and report["failed"] == 0
    return folder


def test_wrenches_are_forces_on_the_plate_s_surface(pressed_scene):
    scene = load_scene(pressed_scene)
    drawn = wrenches.on_plates(scene, np.random.default_rng(0).random((2000, wrenches.draws(scene))))
    force, moment = drawn[:, :3], drawn[:, 3:]
    size = np.linalg.norm(force, axis=1)
    assert size.max() <= FORCE and np.quantile(size, 0.5) > 0.5 * FORCE
    assert np.abs(np.sum(force * moment, axis=1)).max() < 1e-12  # a single force has no moment along itself
    upper = np.array([one["upper"] for one in scene.parameters])[2:]
    assert (np.abs(drawn) <= upper * (1 + 1e-12)).all() and (np.abs(drawn).max(axis=0) > 0.7 * upper).all()
    half = scene.geometry.half_lengths
    arm = np.cross(force, moment) / size[:, None] ** 2  # the point of the line of action nearest to the centre
    assert (np.linalg.norm(arm, axis=1) <= np.linalg.norm(half) * (1 + 1e-9)).all()


def test_held_out_states_of_a_line_begin_at_its_free_state_and_are_those_from_rest(pressed_scene, tmp_path):
    scene, tensions = load_scene(pressed_scene), [70.0, 20.0]
    presses = np.array([[0.0] * 6, [0.0, -2.0, 0.5, 0.0, 0.0, 0.0]])
    points = [[*tensions, *wrench] for wrench in presses]
    description = describe(scene, {}, SimpleNamespace(points=lambda scene, box: points))
    model = FingerModel(scene)
    line = LineSolver(description, model, tmp_path).solve("random-0")
    solved = model.solve(tensions, wrenches=presses[1:], sensitivities=False)
    assert line["converged"].all() and np.abs(line["tip"][1] - solved.tip).max() < 1e-8
    assert line["iterations"][1] < 0.6 * solved.newton_iterations


def test_a_set_holds_free_states_and_pressed_ones_with_exact_derivatives(pressed_scene, pressed_set):
    snapshots = SnapshotSet(pressed_set)
    states = read_section_states(snapshots)
    assert states.inputs.shape == (60, 8) and (states.forces.reshape(15, 4)[:, 0] == 0).all()
    assert snapshots.description.actuators == 2 and not snapshots.description.has_obstacle
    model = FingerModel(load_scene(pressed_scene))
    k = int(np.argmax(states.forces))
    solved = model.solve(states.inputs[k, :2], wrenches=states.inputs[k, 2:].reshape(1, 6))
    assert states.plate.rotations[k] == pytest.approx(solved.plate_rotations[0], abs=1e-9)
    assert states.plate.places[k] == pytest.approx(solved.plate_centres[0], abs=1e-10)
    assert pytest.approx(solved.plate_motion[:, 0], rel=1e-6, abs=1e-9) == states.plate.motions[k].T
    assert solved.parameters["fx"] == states.inputs[k, 2]


def test_every_state_obeys_the_identity_of_a_potential(pressed_set):
    """K - K^T = ad(w), K the inverse of the compliance in the plate's frame: no fit and no tolerance is in it."""
    states = read_section_states(SnapshotSet(pressed_set))
    for motion, wrench in zip(states.plate.motions, states.inputs[:, 2:], strict=True):
        (a, b, c), (d, e, f) = wrench.reshape(2, 3)
        force, moment = (np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) for x, y, z in ((a, b, c), (d, e, f)))
        turned = np.block([[np.zeros((3, 3)), force], [force, moment]])
        stiffness = np.linalg.inv(motion[:, 2:])
        assert np.abs(stiffness - stiffness.T - turned).max() < 1e-4 * max(np.abs(wrench).max(), 1e-3)


def test_tendons_shorten_by_a_wrench_as_the_plate_moves_by_their_tensions(pressed_set):
    """Without a wrench, of one potential: dS/dw = d(motion)/dF, and dS/dF is symmetric and positive definite."""
    states = read_section_states(SnapshotSet(pressed_set))
    motion, free = states.plate.motions, states.forces == 0
    changes = states.shortening_changes[:, -1]
    assert free.sum() == 15 and states.shortenings[:, -1].shape == (60, 2)
    by_wrench, by_tension = changes[free][:, :, 2:], motion[free][:, :, :2].transpose(0, 2, 1)
    assert by_wrench == pytest.approx(by_tension, rel=1e-5, abs=1e-6 * np.abs(by_tension).max())
    own = changes[free][:, :, :2]
    assert own == pytest.approx(own.transpose(0, 2, 1), rel=1e-5, abs=1e-6 * np.abs(own).max())
    assert (np.linalg.eigvalsh(own) > 0).all()


@pytest.mark.long
def test_held_out_states_measure_the_finger_that_is_built(pressed_scene, pressed_set, tmp_path):
    run(2, pressed_scene, tmp_path / "held-out", "--random", "8", "--seed", "3")

    def rom(*words: str) -> dict:
        done = ran("rom", *words, "--json")
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    file = tmp_path / "finger.h5"
    built = rom("build", str(pressed_set), "-o", str(file), "--held-out", str(tmp_path / "held-out"))
    assert built["accuracy"]["contact_force"]["count"] == 8
    assert built["accuracy"]["contact_force"]["median"] < built["contact_force_error"]  # what it expects of itself
    assert rom("check", str(file), str(tmp_path / "held-out")) == built["accuracy"]
    assert rom("info", str(file)) == built
    finger, held_out = Rod.load(file), SnapshotSet(tmp_path / "held-out")
    true, field = read_section_states(held_out), held_out.random("displacement")
    edges = (np.abs(held_out.nodes[:, 1:]) > 0.00499).all(axis=1)
    for state, moved in zip(true.inputs, field, strict=True):
        found = finger.displacement(state[:2], state[None, 2:], held_out.nodes)
        assert np.linalg.norm(found[edges] - moved[edges], axis=1).max() < 2e-4
        assert np.linalg.norm(found - moved, axis=1).max() < 5e-4  # between the corners cross-sections warp
    plane = TouchedSegment(rod=finger, obstacle=facing_plane(0.01, (0.001, 0.05)))
    assert plane.shortening([20.0, 0.0, 0.05]) == pytest.approx(finger.shortening([20.0, 0.0]))
    own = rom("check", str(file), str(pressed_set))
    assert own["training"] and own["states"] == 60 and own["covered"] >= 0.9


@pytest.fixture(scope="module")
def finer_scene(pressed_scene, tmp_path_factory) -> Path:
    """The same finger on twice as many cells, with fewer lines."""
    text = pressed_scene.read_text().replace("cells = [10, 5]", "cells = [20, 5]").replace("lines = 15", "lines = 12")
    file = tmp_path_factory.mktemp("finer") / "finer.toml"
    file.write_text(text)
    return file


@pytest.mark.long
def test_states_that_begin_at_those_of_a_coarser_mesh_are_those_from_rest(finer_scene, pressed_set, tmp_path):
    rest = run(2, finer_scene, tmp_path / "rest")
    near = run(2, finer_scene, tmp_path / "near", "--near", str(pressed_set))
    assert near["failed"] == rest["failed"] == 0 and near["states"] == rest["states"] == 48
    assert near["newton_iterations"] < 0.6 * rest["newton_iterations"]
    true, found = (read_section_states(SnapshotSet(tmp_path / name)) for name in ("rest", "near"))
    assert found.sections.places == pytest.approx(true.sections.places, abs=1e-8)
    assert found.sections.motions == pytest.approx(true.sections.motions, rel=1e-6, abs=1e-6)
    held_out, same = (
        run(2, finer_scene, tmp_path / f"held-out {k}", *options)
        for k, options in enumerate((["--random", "4"], ["--random", "4", "--near", str(pressed_set)]))
    )
    assert same["states"] == held_out["states"] == 4 and same["failed"] == 0
    true, found = (read_section_states(SnapshotSet(tmp_path / f"held-out {k}")) for k in (0, 1))
    assert found.plate.places == pytest.approx(true.plate.places, abs=1e-8)


def test_what_a_load_does_not_go_with_is_refused(pressed_scene):
    scene = load_scene(pressed_scene)
    with pytest.raises(SceneError, match="distances must be 1"):
        describe(scene, {}, HeldOut(count=2, distances=2))
    table = scene.model_dump()
    table["tendons"][0]["name"] = "fx"
    with pytest.raises(ValueError, match=r"tendons.0.name must be unique and no other parameter's, got fx"):
        type(scene).model_validate(table)
