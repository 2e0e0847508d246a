"""Sets of pressed states that grow until their elements predict lines that are left out well enough."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from farm import ROOT, assert_same_task, command, run

from rom.elements import growth
from rom.rod.check import check_pressed
from rom.rod.rod import Rod
from rom.snapshots.plan import Plan
from rom.snapshots.snapshot_set import SnapshotSet, read_description, read_task

UNTIL = "0.07 %"


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """The demo's finger on few cells, of which whole ones make its elements."""
    text = (ROOT / "scenes" / "demo" / "fine.toml").read_text()
    file = tmp_path_factory.mktemp("scene") / "pressed.toml"
    file.write_text(text.split("[mesh]")[0] + "[mesh]\ncells = [11, 5]\n[sampling]\nlines = 20\n")
    return file


@pytest.fixture(scope="module")
def grown(scene, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sets") / "grown"
    result = run(2, scene, folder, "--until", UNTIL)
    assert result["estimated_error"] <= 7e-4 and not result["missing"]
    return folder


def test_lines_are_added_in_their_order_until_the_expected_error_is_small_enough(grown):
    plan = Plan(grown, read_description(grown))
    assert len(plan.rounds) > 1 and not plan.rounds[-1].lines and not plan.rounds[-1].finest
    assert all(one.lines and one.error > 7e-4 for one in plan.rounds[:-1])
    assert list(plan.lines) == [f"pressed-{k}" for k in range(len(plan.lines))]


def test_what_is_expected_covers_what_held_out_states_find(scene, grown, tmp_path):
    run(2, scene, tmp_path / "held-out", "--random", "80", "--seed", "3", "--near", str(grown))
    expected = Plan(grown, read_description(grown)).rounds[-1].error
    words = ["build", str(grown), "-o", str(tmp_path / "finger.h5"), "--json"]
    done = subprocess.run([sys.executable, "-m", "rom", *words], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    finger = Rod.load(tmp_path / "finger.h5")
    found = check_pressed(finger, SnapshotSet(tmp_path / "held-out"))["contact_force"]["p95"]
    assert 0.1 * expected < found < expected  # lines are dense at the box's walls, where fits are worst
    assert finger.errors.contact_force == pytest.approx(expected)


def test_it_is_the_same_set_whoever_solves_it_and_a_smaller_error_goes_on(scene, grown, tmp_path):
    folder = tmp_path / "killed"
    job = subprocess.Popen(command(1, scene, folder, "--until", UNTIL), cwd=ROOT, start_new_session=True)
    deadline = time.monotonic() + 200
    while time.monotonic() < deadline and not (folder / "rounds" / "0000.json").exists():
        time.sleep(0.05)
    os.killpg(job.pid, signal.SIGKILL)
    job.wait()
    run(1, scene, folder, "--until", UNTIL)
    ours, theirs = (Plan(one, read_description(one)) for one in (folder, grown))
    assert list(ours.lines) == list(theirs.lines)
    assert [one.error for one in ours.rounds] == pytest.approx([one.error for one in theirs.rounds])
    for task in ours.lines:
        assert_same_task(read_task(folder, task), read_task(grown, task))
    further = run(2, scene, folder, "--until", "5.2e-4")
    assert further["estimated_error"] <= 5.2e-4 and further["tasks"] > len(theirs.lines)
    assert run(2, scene, folder, "--until", UNTIL)["this_rank"]["lines"] == 0


def test_a_set_of_so_many_lines_has_the_first_of_the_sequence(scene, grown, tmp_path):
    run(2, scene, tmp_path / "twenty")
    tasks = Plan(tmp_path / "twenty", read_description(tmp_path / "twenty")).lines
    assert len(tasks) == 20
    for task in tasks:
        assert_same_task(read_task(tmp_path / "twenty", task), read_task(grown, task))
    done = subprocess.run(
        command(1, scene, tmp_path / "twenty", "--until", UNTIL), cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 2 and "choose a new folder" in done.stderr


def test_when_the_sequence_ends_it_says_so(grown):
    """Of a set that has all lines, the next round has none."""
    snapshots = SnapshotSet(grown)
    count = len(snapshots.plan.lines)
    snapshots.description = replace(
        snapshots.description,
        wrenches=snapshots.description.wrenches[:count],
        scattered=snapshots.description.scattered[:count],
    )
    found = growth.next_round(snapshots, 1e-9)
    assert found.finest and not found.lines and np.isfinite(found.error)
