"""Disasters of a machine: each is really done to a set, and ends in a complete set or in one clear line."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from farm import PATIENCE, ROOT, assert_same, command, run
from terminal import ran

from fingerfem.snapshots import ledger
from fingerfem.snapshots.claims import ClaimFiles, Locks, why_no_locks
from rom.dataset.snapshot_set import read_task, task_file


def begun(line: list[str], folder: Path, files: int, **settings) -> subprocess.Popen:
    """A job that has written some of its files."""
    job = subprocess.Popen(
        line, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True, **settings
    )
    deadline = time.monotonic() + PATIENCE
    while len(list(folder.glob("tasks/*.npz"))) < files:
        assert job.poll() is None and time.monotonic() < deadline, job.communicate()
        time.sleep(0.01)
    return job


def only_line(said: str, name: str) -> str:
    assert "Traceback" not in said
    (line,) = [line for line in said.splitlines() if name in line]
    return line


@pytest.mark.long
def test_a_kill_at_any_change_of_a_file_leaves_nothing_that_passes_as_done(undisturbed, tmp_path, hostile):
    line = [sys.executable, str(Path(__file__).with_name("kills.py")), str(undisturbed), str(tmp_path)]
    settings = {"LD_PRELOAD": hostile, "PYTHONPATH": os.pathsep.join(map(str, [ROOT, ROOT / "tests" / "fingerfem"]))}
    done = subprocess.run(line, cwd=ROOT, env=os.environ | settings, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    kills = json.loads(done.stdout)
    # At least: a write, its fsync and a rename; of a set for its description, its body, two lines and a round.
    assert kills["set"] >= 15 and min(kills.values()) >= 6, kills


def test_sigterm_drops_the_line_at_hand_and_is_no_death(scene, undisturbed, tmp_path):
    job = begun(command(1, scene, tmp_path / "set")[3:], tmp_path / "set", 3)
    job.terminate()
    said = job.communicate(timeout=10)[1]
    assert job.returncode == 128 + signal.SIGTERM
    assert "run the same command again" in only_line(said, "SIGTERM")
    assert not list((tmp_path / "set" / "attempts").iterdir())
    assert not [file for file in (tmp_path / "set" / "tasks").iterdir() if file.name.startswith(".")]
    run(1, scene, tmp_path / "set")
    assert_same(tmp_path / "set", undisturbed)


@pytest.mark.long
def test_sigterm_to_mpirun_ends_all_ranks_in_ten_seconds(scene, tmp_path):
    job = begun(command(2, scene, tmp_path / "set"), tmp_path / "set", 3)
    job.terminate()
    job.communicate(timeout=10)
    assert job.returncode != 0


BUSY = """
import signal, sys
from fingerfem.snapshots import ledger

signal.signal(signal.SIGTERM, lambda *_: None)
ledger.begin(sys.argv[1], "free-0")
print("begun", flush=True)
sum(range(10**10))  # compiled code, during which no handler of Python runs
"""


@pytest.mark.parametrize("asked", [True, False])
def test_a_busy_process_that_is_asked_to_end_and_then_killed_is_no_death(tmp_path, asked):
    for attempt in range(2):
        job = subprocess.Popen([sys.executable, "-c", BUSY, str(tmp_path)], cwd=ROOT, stdout=subprocess.PIPE, text=True)
        assert job.stdout.readline() == "begun\n"
        if asked:
            job.terminate()
            while not (tmp_path / "attempts" / "free-0").read_bytes().endswith(bytes([signal.SIGTERM])):
                time.sleep(0.01)
        job.kill()
        job.wait()
        assert ledger.deaths(tmp_path, "free-0") == (0 if asked else attempt + 1)
    ledger.begin(tmp_path, "free-0")
    assert ledger.deaths(tmp_path, "free-0") == (1 if asked else 3)  # alive, or dead: nobody asks while it works
    ledger.withdraw(tmp_path, "free-0")
    assert ledger.deaths(tmp_path, "free-0") == (0 if asked else 2)


@pytest.mark.long
@pytest.mark.parametrize("options", [[], ["--ranks-per-finger", "2"]])
def test_ctrl_c_at_any_moment_is_hardly_ever_a_death_however_long_a_factorisation_takes(tmp_path, options):
    """On the finer mesh compiled code runs for longer than mpirun waits between asking and killing.

    METIS, which orders unknowns for a good part of that time, takes SIGTERM for itself; SIGCONT comes before.
    """
    deaths, killed = 0, 0
    line = command(2, ROOT / "scenes" / "finer.toml", tmp_path / "set", *options)
    for moment in range(10):
        job = subprocess.Popen(
            line, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        while not list((tmp_path / "set").glob("attempts/*")):
            assert job.poll() is None, job.communicate()
            time.sleep(0.01)
        time.sleep(0.5 + 0.17 * moment)
        os.killpg(job.pid, signal.SIGINT)
        said = job.communicate(timeout=PATIENCE)[1]
        assert job.returncode != 0 and "Traceback" not in said
        notes = [file.name for file in (tmp_path / "set" / "attempts").iterdir()]
        deaths += sum(ledger.deaths(tmp_path / "set", task) for task in notes)
        killed += len(notes)
        shutil.rmtree(tmp_path / "set" / "attempts")
    assert killed and deaths <= 1, (deaths, killed)  # a note that is just begun has no signal's number yet


@pytest.mark.long
def test_three_deaths_at_one_line_quarantine_it_and_what_needs_it_and_retry_solves_them(scene, undisturbed, tmp_path):
    folder = tmp_path / "set"
    shutil.copytree(undisturbed, folder)
    for task in ("free-0", *(f"contact-0-{i}" for i in range(4))):
        task_file(folder, task).unlink()
    for _ in range(ledger.DEATHS):
        ledger.begin(folder, "free-0")  # as a process that dies leaves it
    done = subprocess.run(command(1, scene, folder), cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 3
    assert "free-0 F1=0 F2=0: quarantined: 3 processes died at it" in done.stderr
    assert "free-0 has no answer at these tensions" in done.stderr
    assert not read_task(folder, "free-0")["converged"].any()
    assert np.isnan(read_task(folder, "free-0")["tip"]).all()
    said = ran("fingerfem", "status", folder).stdout
    assert "quarantined              4" in said and "failed                   16" in said
    assert ran("fingerfem", "retry", folder).returncode == 0
    run(1, scene, folder)
    assert_same(folder, undisturbed)


@pytest.mark.long
def test_a_full_disk_is_one_line_and_loses_nothing_that_was_written(scene, undisturbed, tmp_path):
    folder = tmp_path / "small disk"
    folder.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=160k", "none", str(folder)], capture_output=True).returncode:
        pytest.skip("only root can mount a small disk")
    try:
        done = subprocess.run(command(1, scene, folder / "set"), cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 2
        assert only_line(done.stderr, "No space left on device")
        there = list((folder / "set" / "tasks").iterdir())
        assert there and all(file.suffix == ".npz" for file in there)
        shutil.copytree(folder / "set", tmp_path / "larger disk")
    finally:
        subprocess.run(["umount", str(folder)], check=True)
    run(1, scene, tmp_path / "larger disk")
    assert_same(tmp_path / "larger disk", undisturbed)


@pytest.mark.long
def test_a_folder_that_cannot_be_written_to_is_one_line(scene, tmp_path):
    folder = tmp_path / "read only"
    folder.mkdir(mode=0o555)
    user = {"user": 65534} if os.getuid() == 0 else {}  # nothing is read-only to root
    for part in [tmp_path, *(above for above in tmp_path.parents if above.name.startswith(("pytest-", "popen-")))]:
        part.chmod(0o755)
    shutil.copy(scene, tmp_path / "scene.toml")
    line = command(1, tmp_path / "scene.toml", folder / "set")[3:]
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, **user)
    assert done.returncode == 2
    assert "must be a folder that can be written to, got Permission denied" in only_line(done.stderr, "read only")


@pytest.mark.long
@pytest.mark.parametrize("kind", ["none", pytest.param("lying", marks=pytest.mark.long)])
def test_without_working_locks_two_jobs_share_a_set_by_claim_files(scene, undisturbed, tmp_path, hostile, kind):
    settings = {"LD_PRELOAD": hostile, "HOSTILE_LOCKS": kind}
    other = begun(command(1, scene, tmp_path / "set"), tmp_path / "set", 1, env=os.environ | settings)
    ours = run(2, scene, tmp_path / "set", **settings)
    said = other.communicate(timeout=PATIENCE)[1]
    assert other.returncode == 0 and "tasks are claimed by files" in said
    assert_same(tmp_path / "set", undisturbed)
    assert ours["missing"] == 0 and not list((tmp_path / "set" / "claimed").iterdir())


@pytest.mark.long
def test_without_working_locks_a_killed_rank_s_claim_is_taken_over(scene, undisturbed, tmp_path, hostile):
    settings = {"LD_PRELOAD": hostile, "HOSTILE_LOCKS": "none"}
    job = begun(command(1, scene, tmp_path / "set")[3:], tmp_path / "set", 2, env=os.environ | settings)
    os.kill(job.pid, signal.SIGSTOP)
    while not list((tmp_path / "set" / "claimed").iterdir()):  # it was between two tasks
        os.kill(job.pid, signal.SIGCONT)
        time.sleep(0.01)
        os.kill(job.pid, signal.SIGSTOP)
    job.kill()
    job.communicate()
    assert list((tmp_path / "set" / "claimed").iterdir())
    run(1, scene, tmp_path / "set", **settings)
    assert_same(tmp_path / "set", undisturbed)


def test_a_claim_is_dead_when_its_file_rests_for_as_long_as_the_onlooker_is_patient(tmp_path):
    with ClaimFiles(tmp_path, heartbeat=0.02, patience=0.5) as ours:
        assert ours.take(0)
        (tmp_path / "claimed" / "1").write_text("elsewhere/1 1 1")  # another machine's, which is gone
        begun = time.monotonic()
        with ClaimFiles(tmp_path, heartbeat=0.02, patience=0.5) as theirs:
            while not theirs.take(1):
                assert not theirs.take(0) and time.monotonic() - begun < 30
                time.sleep(0.02)
            assert time.monotonic() - begun > 0.5
            assert not theirs.take(0)  # ours is alive
            assert not ours.take(1)


def test_locks_are_trusted_where_they_work_and_freed_by_the_end_of_a_process(tmp_path):
    assert why_no_locks(tmp_path) is None
    hold = (
        "import sys, time; from fingerfem.snapshots.claims import Locks; claims = Locks(sys.argv[1]);"
        "print(claims.take(7), flush=True); time.sleep(60)"
    )
    other = subprocess.Popen([sys.executable, "-c", hold, str(tmp_path)], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    assert other.stdout.readline() == "True\n"
    with Locks(tmp_path) as claims:
        assert not claims.take(7) and claims.take(8)
        other.kill()
        other.wait()
        assert claims.take(7)


@pytest.mark.long
def test_a_clock_that_jumps_changes_nothing(scene, undisturbed, tmp_path, hostile):
    run(2, scene, tmp_path / "set", LD_PRELOAD=hostile, HOSTILE_CLOCK="jumping")
    assert_same(tmp_path / "set", undisturbed)


def test_truncated_and_foreign_files_are_set_aside_and_solved_again(scene, undisturbed, tmp_path):
    folder = tmp_path / "set"
    shutil.copytree(undisturbed, folder)
    task_file(folder, "free-1").write_bytes(task_file(folder, "free-1").read_bytes()[:1000])
    shutil.copy(task_file(folder, "free-2"), task_file(folder, "free-3"))
    np.savez(task_file(folder, "contact-1-1"), stress=np.ones(3))
    (folder / "tasks" / "thesis.npz").write_text("dear diary")
    done = subprocess.run(command(1, scene, folder), cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr.count("moved to") == 4
    assert (folder / "set-aside" / "thesis.npz").read_text() == "dear diary"
    assert_same(folder, undisturbed)


@pytest.mark.long
def test_a_compilation_that_was_killed_does_not_stop_the_next_job(scene, undisturbed, tmp_path):
    cache = {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    first = subprocess.Popen(
        command(1, scene, tmp_path / "set")[3:],
        cwd=ROOT,
        env=os.environ | cache,
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    forms = tmp_path / "cache" / "fingerfem" / "forms"
    while not list(forms.glob("*.*-*/*.c")):  # a private folder
        assert first.poll() is None
        time.sleep(0.001)
    os.killpg(first.pid, signal.SIGKILL)
    first.wait()
    assert list(forms.glob("*.*-*"))
    run(2, scene, tmp_path / "set", **cache)
    assert_same(tmp_path / "set", undisturbed)


@pytest.mark.long
def test_groups_of_ranks_give_the_numbers_of_one_rank(scene, undisturbed, tmp_path):
    run(4, scene, tmp_path / "set", "--ranks-per-finger", "2")
    assert_same(tmp_path / "set", undisturbed, tolerance=1e-9)
    done = subprocess.run(
        command(3, scene, tmp_path / "other", "--ranks-per-finger", "2"), cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert "ranks-per-finger must divide the number of ranks, 3, got 2" in done.stderr
