"""Sets that are refined where the surrogate's doubt is largest, and sets that use another's states again."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from farm import ROOT, assert_same, assert_same_task, command, run
from scipy.interpolate import CubicSpline

from rom.build import train
from rom.refinement.responses import contact_outputs, contact_response
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.plan import Plan
from rom.snapshots.snapshot_set import SnapshotSet, read_description, read_task, task_file, write_task

UNTIL = "0.01"


@pytest.fixture(scope="module")
def planar(scene, tmp_path_factory):
    """The finger of one tendon, which bends in a plane."""
    before, _, after = scene.read_text().partition('[[tendons]]\nname = "F2"')
    file = tmp_path_factory.mktemp("scene") / "planar.toml"
    file.write_text((before + after[after.index("[obstacle]") :]).replace("[0.0, 50.0]", "[0.0, 100.0]"))
    return file


@pytest.fixture(scope="module")
def refined(planar, tmp_path_factory):
    """A set refined by two ranks."""
    folder = tmp_path_factory.mktemp("sets") / "refined"
    result = run(2, planar, folder, "--until", UNTIL)
    assert result["estimated_error"] <= float(UNTIL) and not result["missing"]
    return folder


def assert_same_rounds(one, other):
    ours, theirs = (Plan(folder, read_description(folder)) for folder in (one, other))
    assert list(ours.lines) == list(theirs.lines)
    for here, there in zip(ours.rounds, theirs.rounds, strict=True):
        assert here.lines == there.lines and here.error == there.error
    for task in ours.lines:
        assert_same_task(read_task(one, task), read_task(other, task))


def test_rounds_add_lines_until_the_estimated_error_is_small_enough(refined):
    plan = Plan(refined, read_description(refined))
    assert len(plan.rounds) > 1 and not plan.rounds[-1].lines
    assert all(one.lines and one.error > float(UNTIL) for one in plan.rounds[:-1])
    snapshots = SnapshotSet(refined)
    for kind in ("free", "contact"):
        positions = snapshots.positions(kind)
        assert len(np.unique(positions, axis=0)) == len(positions)  # no state is solved twice
    assert snapshots.lines["contact-0-0"].nodes == tuple(range(33))  # at onset one state stands for all of them
    solved = len(snapshots.positions("contact")) - 33
    assert solved < 0.5 * np.prod([17, 33])  # of the finest grid


def test_refining_does_not_depend_on_ranks_nor_on_jobs_that_are_killed(planar, refined, tmp_path):
    folder = tmp_path / "killed"
    job = subprocess.Popen(command(1, planar, folder, "--until", UNTIL), cwd=ROOT, start_new_session=True)
    deadline = time.monotonic() + 200
    while time.monotonic() < deadline and not (folder / "rounds" / "0001.json").exists():
        time.sleep(0.05)
    os.killpg(job.pid, signal.SIGKILL)
    job.wait()
    run(1, planar, folder, "--until", UNTIL)
    assert_same_rounds(folder, refined)


def test_a_smaller_tolerance_goes_on_where_the_larger_ended_and_a_larger_one_does_nothing(planar, refined, tmp_path):
    folder = tmp_path / "further"
    shutil.copytree(refined, folder)
    assert run(2, planar, folder, "--until", "0.02")["this_rank"]["lines"] == 0
    before = SnapshotSet(folder).states
    result = run(2, planar, folder, "--until", "0.006")
    assert result["estimated_error"] <= 0.006 and result["states"] > before
    for task in Plan(refined, read_description(refined)).lines:
        assert_same_task(read_task(folder, task), read_task(refined, task))


def test_a_budget_ends_a_run_and_another_goes_on(planar, refined, tmp_path):
    folder = tmp_path / "budget"
    first = subprocess.run(command(2, planar, folder, "--budget", "0.1s"), cwd=ROOT, capture_output=True, text=True)
    assert first.returncode == 0 and "the budget is spent" in first.stderr
    assert json.loads(first.stdout)["missing"] > 0
    run(2, planar, folder, "--until", UNTIL)
    assert_same_rounds(folder, refined)


def test_without_a_plane_a_few_free_states_do(planar, tmp_path):
    from rom.held_out import check

    free = tmp_path / "free.toml"
    before, _, after = planar.read_text().partition("[obstacle]")
    free.write_text(before + after[after.index("[mesh]") :])
    result = run(1, free, tmp_path / "set", "--until", "1e-4")
    assert result["states"] < 17
    assert "estimated error" in (tmp_path / "set" / "progress.log").read_text()
    run(1, free, tmp_path / "held", "--random", "30")
    model = train(SnapshotSet(tmp_path / "set"), EnrichmentOptions(tolerance=1e-8))
    assert check(model, SnapshotSet(tmp_path / "held"))["tip"]["p95"] < 2e-4


def test_four_tensions_are_too_many_to_refine(tmp_path):
    line = command(1, ROOT / "scenes" / "four_tendons.toml", tmp_path / "set", "--until", "0.1")
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and "tendons must be at most 3 to refine their grid, got 4" in done.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--budget", "soon"), "budget must be a time such as 90s, 30min or 2h, got 'soon'"),
        (("--budget", "0s"), "budget must be a time such as 90s, 30min or 2h, got '0s'"),
        (("--until", "0"), "until must lie in (0, 1), got 0.0"),
        (("--until", "nan"), "until must lie in (0, 1), got nan"),
        (("--until", "0.1", "--random", "3"), "random or points must not be given with until, budget or reuse"),
    ],
)
def test_goals_that_make_no_sense_are_refused_in_one_line(options, words, planar, tmp_path):
    done = subprocess.run(command(1, planar, tmp_path / "set", *options), cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and words in done.stderr and "Traceback" not in done.stderr


def test_a_uniform_set_is_not_refined_and_a_refined_one_not_made_uniform(scene, planar, undisturbed, refined):
    for file, folder, options in ((scene, undisturbed, ("--until", "0.1")), (planar, refined, ())):
        done = subprocess.run(command(1, file, folder, *options), cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 2 and "choose a new folder" in done.stderr


def test_a_round_that_is_not_whole_is_one_line_and_planned_again(planar, refined, tmp_path):
    folder = tmp_path / "broken"
    shutil.copytree(refined, folder)
    file = folder / "rounds" / "0001.json"
    file.write_text(file.read_text()[:100])
    with pytest.raises(ValueError, match=r"0001\.json: is not a round of a set; run snapshots again"):
        SnapshotSet(folder)
    run(1, planar, folder, "--until", UNTIL)
    assert_same_rounds(folder, refined)


def test_a_failed_state_of_a_round_never_reaches_the_surrogate(refined, tmp_path, caplog):
    folder = tmp_path / "failed"
    shutil.copytree(refined, folder)
    plan = Plan(folder, read_description(folder))
    task = next(
        name for name, line in plan.lines.items() if name not in plan._description.lines and len(line.nodes) > 1
    )
    _fail(folder, task)
    model = train(SnapshotSet(folder), EnrichmentOptions(tolerance=1e-3))
    assert model.provenance["failed"] == 1
    assert f"done without the failed state of {task}" in caplog.text
    _fail(folder, "contact-0-8")
    assert train(SnapshotSet(folder), EnrichmentOptions(tolerance=1e-3)).provenance["failed"] == 2


def _fail(folder, task: str, which=-1) -> None:
    """Let states of a task have failed."""
    arrays = dict(read_task(folder, task))
    for name, values in arrays.items():
        if values.dtype.kind == "f" and values.ndim and name not in ("parameters", "onset_jacobian"):
            values[which] = np.nan
    arrays["converged"][which] = False
    write_task(folder, task, str(arrays["fingerprint"]), arrays)


def test_the_surrogate_of_a_refined_set_keeps_the_error_that_was_estimated(planar, refined, tmp_path):
    from rom.held_out import check

    run(2, planar, tmp_path / "held", "--random", "100", "--seed", "5")
    model = train(SnapshotSet(refined), EnrichmentOptions(tolerance=1e-5))
    ours = check(model, SnapshotSet(tmp_path / "held"))["contact_force"]
    assert ours["p95"] < 2 * float(UNTIL)


def test_a_line_whose_state_at_touch_failed_is_not_planned_again(planar, refined, tmp_path):
    folder = tmp_path / "untouched"
    shutil.copytree(refined, folder)
    snapshots = SnapshotSet(folder)
    task, line = next((name, line) for name, line in snapshots.plan.rounds[0].lines.items() if 0 in line.nodes)
    _fail(folder, task, slice(None))
    for file in sorted((folder / "rounds").iterdir())[1:]:
        file.unlink()
    done = run(2, planar, folder, "--until", UNTIL)
    assert done["failed"] == len(line.nodes)
    again = [name for name in Plan(folder, snapshots.description).lines if name.startswith(task.rsplit("-", 1)[0])]
    assert again == [task]
    assert train(SnapshotSet(folder), EnrichmentOptions(tolerance=1e-3)).provenance["failed"] == len(line.nodes)


def test_a_first_grid_with_a_failed_state_is_not_refined_and_says_so(planar, refined, tmp_path):
    folder = tmp_path / "unusable"
    shutil.copytree(refined, folder)
    shutil.rmtree(folder / "rounds")
    _fail(folder, "contact-0-8")
    done = subprocess.run(command(1, planar, folder, "--until", UNTIL), cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 3 and json.loads(done.stdout)["failed"] == 1
    assert "not refined: " in done.stderr and "failed: contact-0-8" in done.stderr and "retry" in done.stderr


def test_a_retry_plans_the_last_round_again(planar, refined, tmp_path):
    folder = tmp_path / "retried"
    shutil.copytree(refined, folder)
    plan = Plan(folder, read_description(folder))
    _fail(folder, next(iter(plan.rounds[0].lines)))
    subprocess.run([sys.executable, "-m", "fingerfem", "retry", str(folder)], cwd=ROOT, check=True)
    assert len(Plan(folder, plan._description).rounds) == len(plan.rounds) - 1
    run(1, planar, folder, "--until", UNTIL)
    assert_same_rounds(folder, refined)


def test_a_round_off_the_grid_is_refused(refined, tmp_path):
    folder = tmp_path / "off"
    shutil.copytree(refined, folder)
    file = folder / "rounds" / "0000.json"
    table = json.loads(file.read_text())
    table["lines"] = {"contact-0-3-r0": ["contact", [0, 3], [99]]}
    file.write_text(json.dumps(table))
    with pytest.raises(ValueError, match=r"0000\.json: must hold lines of its set's grid"):
        SnapshotSet(folder)


# -- two tensions ------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module", params=["lead first", pytest.param("lead second", marks=pytest.mark.long)])
def two(request, spatial, tmp_path_factory):
    """The first grid of two tensions, on a finger of few cells, with the tendons in either order."""
    text = spatial.read_text().replace("[0.0, 100.0]", "[0.0, 40.0]").replace("[0.001, 0.031]", "[0.001, 0.011]")
    if request.param == "lead second":
        head, one, other = text.partition("[obstacle]")[0].split("[[tendons]]")
        text = "[[tendons]]".join([head, other, one]) + "[obstacle]" + text.partition("[obstacle]")[2]
    folder = tmp_path_factory.mktemp("two")
    (folder / "scene.toml").write_text(text)
    run(2, folder / "scene.toml", folder / "set", "--until", "0.9")
    return SnapshotSet(folder / "set")


def test_slopes_in_contact_aligned_coordinates_are_differences_of_the_states(two):
    response = contact_response(two, *contact_outputs(two))
    lead, last = two.description.lead, len(response.axes) - 1
    inside = tuple(slice(None, None, stride) for stride in response.strides)
    values = response.values[inside]
    assert response.known[inside].all()
    for a, slopes in enumerate(response.slopes):
        nodes = response.axes[a][:: response.strides[a]]
        differences = CubicSpline(nodes, values, axis=a)(nodes, 1)
        # Away from onset and touch, where the derivatives of what contact adds jump.
        beyond = [slice(None)] * values.ndim
        beyond[lead], beyond[last] = slice(2, None), slice(2, None)
        error = np.abs(differences - slopes[inside])[tuple(beyond)].reshape(-1, 4)
        size = np.abs(slopes[inside])[tuple(beyond)].reshape(-1, 4).max(axis=0)
        assert np.all(np.median(error, axis=0) < 0.02 * size), a


def test_the_onset_s_slopes_are_differences_of_onsets(two):
    description = two.description
    (other,) = description.other_axes
    solved = slice(None, None, description.strides[other])
    nodes, onset = np.array(description.tension_nodes[other])[solved], two.onset()[solved]
    slopes = two.onset("onset_jacobian")[solved, other]
    chords = np.diff(onset) / np.diff(nodes)
    errors = np.abs((slopes[1:] + slopes[:-1]) / 2 - chords) / chords.max()
    # In one interval another corner begins to touch first; the first node, without tension, has a kink of its own.
    assert np.sort(errors[1:])[:-1].max() < 0.01


# -- another set's states ----------------------------------------------------------------------------------------------


@pytest.mark.long
def test_a_finer_grid_uses_the_states_of_a_coarser_one_again(scene, undisturbed, tmp_path):
    finer = tmp_path / "finer.toml"
    finer.write_text(scene.read_text().replace("tension_nodes = 4", "tension_nodes = 7"))
    reused = run(2, finer, tmp_path / "reused", "--reuse", str(undisturbed))
    fresh = run(2, finer, tmp_path / "fresh")
    ours, theirs = SnapshotSet(tmp_path / "reused"), SnapshotSet(tmp_path / "fresh")
    coarse = SnapshotSet(undisturbed)
    assert np.array_equal(ours.free("tip")[::2, ::2], coarse.free("tip"))
    assert np.array_equal(ours.contact("contact_force")[::2, ::2], coarse.contact("contact_force"))
    assert not ours.contact("iterations")[::2, ::2].any() and not ours.free("iterations")[::2, ::2].any()
    assert ours.contact("tip") == pytest.approx(theirs.contact("tip"), abs=1e-8)
    assert ours.contact("contact_force") == pytest.approx(theirs.contact("contact_force"), abs=1e-5)
    assert ours.onset() == pytest.approx(theirs.onset(), abs=1e-5)
    saved = 1 - reused["newton_iterations"] / fresh["newton_iterations"]
    assert saved > 0.1, saved  # states between regimes, and lines where these are small, are solved again


def test_a_set_that_keeps_no_fields_is_used_again_too(planar, tmp_path):
    coarse, finer = tmp_path / "coarse.toml", tmp_path / "finer.toml"
    coarse.write_text(planar.read_text() + "store = []\n")
    finer.write_text(coarse.read_text().replace("_nodes = 4", "_nodes = 7"))
    run(2, coarse, tmp_path / "coarse")
    run(2, finer, tmp_path / "reused", "--reuse", str(tmp_path / "coarse"))
    run(2, finer, tmp_path / "fresh")
    ours, theirs = SnapshotSet(tmp_path / "reused"), SnapshotSet(tmp_path / "fresh")
    assert ours.contact("contact_force") == pytest.approx(theirs.contact("contact_force"), abs=1e-5)
    assert not ours.contact("iterations")[::2, ::2].any() and ours.contact("iterations").any()


def test_states_of_another_finger_are_not_used_again(scene, undisturbed, tmp_path):
    other = tmp_path / "other.toml"
    other.write_text(scene.read_text().replace("C1 = 1.9e6", "C1 = 2.0e6"))
    line = command(1, other, tmp_path / "set", "--reuse", str(undisturbed))
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and "must be a set of the same scene to be used again" in done.stderr
    assert not (tmp_path / "set").exists()


def test_two_jobs_refine_one_set_together(planar, refined, tmp_path):
    folder = tmp_path / "together"
    jobs = [
        subprocess.Popen(command(1, planar, folder, "--until", UNTIL), cwd=ROOT, stdout=subprocess.PIPE)
        for _ in range(2)
    ]
    assert [job.wait(timeout=300) for job in jobs] == [0, 0]
    assert_same_rounds(folder, refined)
    assert task_file(folder, "free-0").exists() and assert_same(folder, refined) is None
