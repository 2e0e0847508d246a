"""Requests and jobs: what goes together, what is refused, and when a set cannot be used."""

import math
from pathlib import Path
from types import SimpleNamespace

import pytest
from mpi4py import MPI

from fingerfem.scene.scene import Scene
from fingerfem.snapshots.job import Job, Request

FOLDER = Path("somewhere")
HELD_OUT = SimpleNamespace()  # points that are not looked at before a job begins


@pytest.fixture
def grid(table) -> Scene:
    return Scene.model_validate(table)


@pytest.fixture
def pressed(table) -> Scene:
    del table["obstacle"]
    return Scene.model_validate(table | {"load": {"force": 3.0}, "sampling": {"lines": 16}})


def test_a_request_grows_if_it_has_a_goal_or_an_end(pressed, grid):
    goals = [{}, {"until": 0.01}, {"budget": 60.0}, {"until": 0.5, "budget": 1.0}, {"budget": math.inf}]
    found = [Request(scene=pressed, folder=FOLDER, **one).grows for one in goals]
    assert found == [False, True, True, True, False] and not Request(scene=grid, folder=FOLDER, reuse=FOLDER).grows


@pytest.mark.parametrize("until", [0.0, 1.0, -0.1, 7.0, math.nan, math.inf])
def test_an_error_that_is_no_share_is_refused(pressed, until):
    with pytest.raises(ValueError, match=r"until must be a share such as"):
        Request(scene=pressed, folder=FOLDER, until=until)


@pytest.mark.parametrize(
    ("load", "wrong", "message"),
    [
        (False, {"until": 0.1}, "until must be left out for a scene without a load, got 0.1"),
        (False, {"budget": 60.0}, "budget must be left out for a scene without a load, got 60"),
        (
            False,
            {"near": FOLDER},
            "near must be left out for training states of a scene without a load",
        ),
        (True, {"reuse": FOLDER}, "reuse must be left out for a scene with a load, got somewhere"),
        (True, {"held_out": HELD_OUT, "until": 0.1}, "random or points must not be given with until"),
        (True, {"held_out": HELD_OUT, "budget": 1.0}, "random or points must not be given with until"),
        (False, {"held_out": HELD_OUT, "reuse": FOLDER}, "random or points must not be given with until"),
    ],
)
def test_what_does_not_go_together_is_refused_before_a_folder_is_made(pressed, grid, load, wrong, message):
    with pytest.raises(ValueError) as refused:
        Request(scene=pressed if load else grid, folder=FOLDER, **wrong)
    assert str(refused.value).startswith(message)
    Request(scene=pressed if load else grid, folder=FOLDER, held_out=HELD_OUT, near=FOLDER)  # these do
    assert not FOLDER.exists()


def test_a_job_makes_its_folder_once_and_finds_all_of_it_missing(grid, tmp_path):
    jobs = [Job(request=Request(scene=grid, folder=tmp_path / "set"), world=MPI.COMM_SELF) for _ in range(2)]
    missing = [sorted(one.ledger.plan.missing()) for one in jobs]
    assert missing[0] == missing[1] == sorted(jobs[0].description.lines) and len(missing[0]) > 4
    assert jobs[0].description == jobs[1].description and jobs[0].is_first and not jobs[0].is_unusable
    assert (tmp_path / "set" / "set.json").exists() and not (tmp_path / "set" / "set-aside").exists()


def test_a_set_is_unusable_where_a_state_failed_that_a_model_needs():
    def judged(failures, held_out=None, solved=5):
        job = object.__new__(Job)
        job.request = SimpleNamespace(held_out=held_out)
        job.description = SimpleNamespace(lines=["pressed-0", "pressed-1"])
        job.ledger = SimpleNamespace(failures=failures, summary=lambda: {"solved": solved})
        return job.is_unusable

    assert not judged([]) and judged([("pressed-1", 3, "why")])
    assert not judged([("pressed-7", 0, "why")])  # a line that was added
    assert not judged([("pressed-1", 3, "why")], held_out=HELD_OUT)
    assert judged([("pressed-1", 3, "why")], held_out=HELD_OUT, solved=0)
