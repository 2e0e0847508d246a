"""The farm: the same numbers whoever solves them, nothing solved twice, nothing lost to a killed rank."""

import os
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from farm import ROOT, assert_same, assert_same_task, command, run

from fingerfem import FingerModel, load_scene
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet, read_description, read_task, task_file


def test_a_set_keeps_free_states_and_contact_states_apart(undisturbed):
    snapshots = SnapshotSet(undisturbed)
    assert snapshots.failures == []
    assert snapshots.free("tip").shape == (4, 4, 3)
    assert snapshots.contact("contact_force").shape == (4, 4, 4)
    assert np.isnan(snapshots.free("parameters")[..., 2]).all()
    force, distance = snapshots.contact("contact_force"), snapshots.contact("parameters")[..., 2]
    reached = snapshots.free("touch_distance") > 0.001
    assert not reached[0, 0] and reached[1:].all()  # the lead tension bends the finger towards the plane
    assert np.array_equal(np.isfinite(force), np.repeat(reached[..., None], 4, axis=-1))
    assert (force[reached] > 0).all() and (np.diff(distance[reached], axis=-1) < 0).all()
    assert distance[reached][:, -1] == pytest.approx(0.001)
    touch = snapshots.free("touch_distance")[reached]
    assert distance[reached][:, 0] == pytest.approx(touch - 0.02 * (touch - 0.001))


@pytest.mark.long
def test_the_numbers_do_not_depend_on_the_number_of_ranks(scene, undisturbed, tmp_path):
    run(3, scene, tmp_path / "three")
    assert_same(tmp_path / "three", undisturbed)


def test_a_complete_set_is_not_solved_again_and_a_missing_task_alone(scene, undisturbed):
    stamps = {file: file.stat().st_mtime_ns for file in (undisturbed / "tasks").iterdir()}
    assert run(2, scene, undisturbed)["this_rank"]["lines"] == 0
    lost = task_file(undisturbed, "contact-2-1")
    before = read_task(undisturbed, "contact-2-1")
    lost.unlink()
    assert run(1, scene, undisturbed)["this_rank"]["lines"] == 1
    assert_same_task(read_task(undisturbed, "contact-2-1"), before)
    assert all(file.stat().st_mtime_ns == stamp for file, stamp in stamps.items() if file != lost)


@pytest.mark.parametrize(
    "recovery",
    [pytest.param(False, id="plain mpirun"), pytest.param(True, id="mpirun --enable-recovery", marks=pytest.mark.long)],
)
def test_killing_a_rank_and_running_again_ends_in_the_undisturbed_set(scene, undisturbed, tmp_path, recovery):
    folder = tmp_path / "killed"
    line = command(2, scene, folder)
    if recovery:
        line.insert(1, "--enable-recovery")
    job = subprocess.Popen(line, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
    try:
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline and len(list(folder.glob("tasks/*.npz"))) < 3:
            time.sleep(0.02)
        ranks = [int(pid) for pid in subprocess.check_output(["pgrep", "-P", str(job.pid)], text=True).split()]
        victims = [pid for pid in ranks if b"fingerfem" in Path(f"/proc/{pid}/cmdline").read_bytes()]
        assert len(victims) == 2
        os.kill(victims[1], signal.SIGKILL)
        job.wait(timeout=300)
    finally:
        if job.poll() is None:
            os.killpg(job.pid, signal.SIGKILL)
    if recovery:
        assert_same(folder, undisturbed)  # the other rank did what the dead one left
    else:
        assert 3 <= len(list(folder.glob("tasks/*.npz"))) < len(read_description(folder).tasks)
    run(2, scene, folder)
    assert_same(folder, undisturbed)


@pytest.mark.long
def test_held_out_states_are_drawn_from_the_seed_and_solved_from_rest(scene, tmp_path):
    run(2, scene, tmp_path / "held", "--random", "6", "--seed", "3")
    snapshots = SnapshotSet(tmp_path / "held")
    points = snapshots.random("parameters")
    box = np.array([[0, 50], [0, 10], [0.001, 0.031]])
    draw = np.random.default_rng(3).random((6, 3))
    assert points == pytest.approx(box[:, 0] + draw * (box[:, 1] - box[:, 0]))
    touching = snapshots.random("touch_distance") > points[:, 2]
    assert np.array_equal(snapshots.random("contact_force") > 0, touching)


@pytest.mark.long
def test_held_out_planes_at_the_same_tensions_are_what_they_are_from_rest(scene, tmp_path):
    run(2, scene, tmp_path / "held", "--random", "3", "--seed", "5", "--distances", "3")
    snapshots = SnapshotSet(tmp_path / "held")
    points, force = snapshots.random("parameters"), snapshots.random("contact_force")
    assert len(snapshots.plan.lines) == 3 and points.shape == (9, 3) and (force > 0).sum() >= 3
    assert len(np.unique(points[:, :2], axis=0)) == 3
    model = FingerModel(load_scene(scene))
    for point, tip, pressed in zip(points, snapshots.random("tip"), force, strict=True):
        state = model.solve(point[:2], point[2], sensitivities=False)
        assert tip == pytest.approx(state.tip, abs=1e-9)
        assert pressed == pytest.approx(state.contact_force, abs=1e-6)


@pytest.mark.long
def test_distances_without_held_out_points_or_without_a_plane_are_refused(scene, tmp_path):
    free = tmp_path / "free.toml"
    free.write_text((ROOT / "scenes" / "free.toml").read_text())
    for file, options in ((scene, ["--distances", "2"]), (free, ["--random", "2", "--distances", "2"])):
        done = subprocess.run(command(1, file, tmp_path / "set", *options), cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 2
        assert done.stderr.strip().startswith("distances must be") and len(done.stderr.strip().splitlines()) == 1


@pytest.mark.long
def test_two_jobs_that_begin_different_sets_in_one_folder_do_not_mix(scene, tmp_path):
    folder = tmp_path / "contested"
    jobs = [
        subprocess.Popen(command(1, scene, folder, *options), cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for options in (("--random", "2"), ("--random", "3"))
    ]
    said = [job.communicate(timeout=120)[1].decode() for job in jobs]
    codes = [job.returncode for job in jobs]
    assert sorted(codes) == [0, 2]
    assert "holds a set of other held-out points" in said[codes.index(2)]
    snapshots = SnapshotSet(folder)
    assert len(list(folder.glob("tasks/*.npz"))) == snapshots.states


def test_an_unfinished_or_a_broken_set_is_not_read(scene, undisturbed, tmp_path):
    import shutil

    copy = tmp_path / "copy"
    shutil.copytree(undisturbed, copy)
    task_file(copy, "free-0").write_bytes(task_file(copy, "free-0").read_bytes()[:1000])
    with pytest.raises(SnapshotError, match=r"free-0\.npz: is missing or not readable"):
        SnapshotSet(copy).free("tip")
    run(1, scene, copy)
    assert_same(copy, undisturbed)  # what was not whole was solved again
    task_file(copy, "free-0").unlink()
    with pytest.raises(SnapshotError, match="1 of 20 tasks are not solved yet"):
        SnapshotSet(copy)
    with pytest.raises(SnapshotError, match="is not a snapshot set"):
        SnapshotSet(tmp_path)


@pytest.mark.long
def test_stored_derivatives_are_differences_of_states(scene, undisturbed):
    """A contact state and a free one: by every parameter, against states solved beside it."""
    from fingerfem import FingerModel, load_scene

    model = FingerModel(load_scene(scene))
    line, free = read_task(undisturbed, "contact-1-2"), read_task(undisturbed, "free-1")
    tensions, d = line["parameters"][2, :2], line["parameters"][2, 2]
    for k, h in enumerate((1e-3, 1e-3, 1e-7)):
        low, high = (
            model.solve(tensions + side * h * np.eye(3)[k, :2], d + side * h * (k == 2), sensitivities=False)
            for side in (-1, 1)
        )
        for name in ("tip", "contact_force"):
            slope = (np.array(getattr(high, name)) - getattr(low, name)) / (2 * h)
            assert line[f"{name}_jacobian"][2, ..., k] == pytest.approx(slope, rel=1e-4, abs=1e-8), name
        field = (high.displacement - low.displacement).reshape(-1, 3) / (2 * h)
        order = np.lexsort(np.round(model.problem.space.tabulate_dof_coordinates(), 9).T[::-1])
        stored = line["displacement_jacobian"][2, k]
        assert np.abs(stored - field[order]).max() < 1e-4 * np.abs(stored).max()
        assert line["displacement_jacobian"].dtype == np.float32
    tensions = free["parameters"][2, :2]
    for k in range(2):
        low, high = (model.solve(tensions + side * 1e-3 * np.eye(2)[k], sensitivities=False) for side in (-1, 1))
        slope = (high.touch_distance - low.touch_distance) / 2e-3
        assert free["touch_distance_jacobian"][2, k] == pytest.approx(slope, rel=1e-4)
    assert np.all(free["touch_distance_jacobian"][:, 2] == 0) and np.all(free["contact_force_jacobian"] == 0)
    assert np.array_equal(line["touch_distance_jacobian"][0], line["touch_distance_jacobian"][-1])


@pytest.mark.long
@pytest.mark.parametrize(("states", "ranks"), [(7, 3), (1, 4)])
def test_ranks_that_share_few_or_uneven_states_end_with_all_of_them(scene, tmp_path, states, ranks):
    report = run(ranks, scene, tmp_path / "held", "--random", str(states), "--seed", "1")
    assert report["ranks"] == ranks and report["failed"] == 0 and SnapshotSet(tmp_path / "held").states == states
