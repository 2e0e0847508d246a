"""The authors' sweep: no infinity, nothing outside the limits, every unreachable target flagged."""

import json

import numpy as np
import pytest
from terminal import ran

from control.campaign import run
from control.least_squares import CONVERGED, STATIONARY


def test_every_answer_of_the_sweep_is_inside_the_limits_and_judged_rightly(table):
    result = run(table, 2500, 1.0, sweep=True).as_json()
    assert result["starts"] == 2500 and result["failed"] == 0 and result["out_of_limits"] == result["infinite"] == 0
    distances = np.linspace(0.004, 0.031, 50)
    grid = [[f1, f2, d] for d in distances for f1 in np.linspace(0, 100, 41) for f2 in np.linspace(0, 100, 21)]
    most = table.evaluate(np.array(grid)).contact_force.reshape(50, -1).max(axis=1)
    assert result["unreachable"] == 50 * np.count_nonzero(most < 1.0)


@pytest.mark.parametrize("force", [0.02, 0.3, 5.0])
def test_a_dense_search_agrees_with_every_flag_of_random_starts(table, force):
    """A search that finds points above the target and below it has not yet found the target: forces may jump."""
    found = run(table, 1500, force)
    axes = [np.linspace(0, 100, 101)] * 2
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    assert found.residual[found.status == CONVERGED].max() <= 1e-6
    for i in np.flatnonzero(found.status != CONVERGED):
        most = table.evaluate(np.column_stack([grid, np.full(len(grid), found.distances[i])])).contact_force.max()
        assert most < force
        assert force - found.residual[i] >= 0.95 * most  # and the answer is nearly the best there is
        assert found.status[i] == STATIONARY or most == 0  # where nothing touches, the evaluations may not suffice


def test_the_commands_answer_in_strict_json_and_flag_by_exit_code(table_file):
    def control(*words):
        done = ran("control", words[0], table_file, *words[1:], "--json")
        return done.returncode, json.loads(done.stdout, parse_constant=lambda word: 1 / 0)

    code, held = control("hold", "--distance", "0.01")
    assert code == 0 and held["status"] == "converged"
    code, far = control("reach", "0.0", "-0.2", "0.0")
    assert code == 3 and far["status"] == "unreachable" and far["distance"] is None
    code, grasp = control("grasp")
    assert code == 0 and grasp["status"] == ["converged"] * 3
    code, egg = control("grasp", "--object", "0.06", "0.5", "3")
    assert code == 0 and egg["contact_forces"] == pytest.approx([1.09] * 3, rel=0.01)  # sqrt(0.39 3) N
    code, stone = control("grasp", "--object", "2", "0.3", "5")
    assert code == 3 and "are crushed above 5 N" in stone["reason"]
    code, sweep = control("campaign", "--starts", "105", "--sweep")
    assert code == 0 and sweep["starts"] == 100
    code, starts = control("campaign", "--starts", "105")
    assert code == 0 and starts["starts"] == starts["converged"] + starts["unreachable"] == 105
    assert (
        starts.keys()
        == sweep.keys()
        >= {
            "converged",
            "unreachable",
            "failed",
            "out_of_limits",
            "mean_us",
            "p50_us",
            "p99_us",
            "max_us",
        }
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["hold", "--distance", "10"], "distance must lie in [0.004, 0.031] m, got 10"),
        (["hold", "--distance", "0.01", "--contact-force", "0"], "contact_force must be above 0 N, got 0"),
        (["hold", "--distance", "0.01", "--pad-pressure", "1e5"], "model must have its pad's pressure"),
        (["campaign", "--contact-force", "-1"], "contact_force must be above 0 N, got -1"),
        (["grasp", "--contact-force", "nan"], "contact_force must be above 0 N, got nan"),
        (["grasp", "--radius", "1.0"], "must lie in the trained box"),
    ],
)
def test_bad_input_is_reported_and_ends_with_code_2(table_file, words, said):
    done = ran("control", words[0], table_file, *words[1:])
    assert done.returncode == 2 and done.stdout == ""
    assert said in done.stderr and len(done.stderr.strip().splitlines()) == 1
