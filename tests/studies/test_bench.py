"""The bench sees what changed, and nothing else."""

import copy
import json

import pytest

from studies.bench import RECORD, compare, numbers
from studies.runner import STUDIES

RECORDED = {
    "solver": {
        "states": 12,
        "seconds": 3.0,
        "times_faster": 2.0,
        "force_error_max": 0.25,
        "rows": [{"name": "a", "error": 1e-3, "ok": "right"}],
    }
}


def changed(**values) -> dict:
    found = copy.deepcopy(RECORDED)
    for key, value in values.items():
        (found["solver"]["rows"][0] if key in ("name", "error", "ok") else found["solver"])[key] = value
    return found


@pytest.mark.parametrize(
    "values", [{}, {"seconds": 30.0}, {"error": 1.005e-3}, {"times_faster": 1.2}, {"times_faster": 3.5}]
)
def test_times_errors_within_a_hundredth_and_ratios_within_two_are_the_same(values):
    assert compare(changed(**values), RECORDED) == []


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"states": 13}, ["/solver/states: 12 on record, now 13"]),
        ({"error": 1.02e-3}, ["/solver/rows/a/error: 0.001 on record, now 0.00102"]),
        ({"error": float("nan")}, ["/solver/rows/a/error: 0.001 on record, now nan"]),
        ({"force_error_max": 0.5}, ["/solver/force_error_max: 0.25 on record, now 0.5"]),
        ({"ok": "WRONG"}, ["/solver/rows/a/ok: right on record, now WRONG"]),
        ({"times_faster": 0.9}, ["/solver/times_faster: 2.0 on record, now 0.9"]),
        ({"terms": 4}, ["/solver/terms: not on record, now 4"]),
    ],
)
def test_counts_verdicts_errors_and_ratios_that_differ_are_told_one_a_line(values, told):
    assert compare(changed(**values), RECORDED) == told


def test_one_time_that_grew_beside_its_others_is_told_on_a_machine_of_any_speed():
    record = {"control": {"solve_us": 10.0, "call_us": 20.0, "mean_us": 30.0, "max_us": 90.0}}
    assert compare({"control": {"solve_us": 50.0, "call_us": 90.0, "mean_us": 140.0, "max_us": 9e4}}, record) == []
    assert compare({"control": {"solve_us": 100.0, "call_us": 21.0, "mean_us": 29.0, "max_us": 90.0}}, record) == [
        "/control/solve_us: 10 times as long as on record, the others of its study 1.1 times"
    ]


def test_what_is_gone_is_told():
    (line,) = compare(
        {"solver": {key: RECORDED["solver"][key] for key in ("states", "seconds", "force_error_max", "rows")}}, RECORDED
    )
    assert line == "/solver/times_faster: 2.0 on record, now gone"


def test_what_is_on_record_is_of_studies_with_no_two_numbers_of_one_name():
    record = json.loads(RECORD.read_text())
    assert set(record) <= set(STUDIES)
    for name, study in record.items():
        paths = [path for path, _ in numbers(study)]
        assert len(paths) == len(set(paths)) > 20, name


def test_rows_of_one_name_are_told_apart():
    paths = [path for path, _ in numbers({"rows": [{"name": "a", "error": 1.0}, {"name": "a", "error": 2.0}]})]
    assert len(paths) == len(set(paths)) == 4
