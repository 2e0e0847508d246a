"""When elements need no more lines of states."""

import json

import pytest

from rom.dataset.plan import Plan, round_file
from rom.elements.fitting.growth import STALE, has_stalled


def test_errors_that_fall_go_on_and_errors_that_stay_end():
    falling = [0.5**k for k in range(12)]
    assert not any(has_stalled(falling[:k]) for k in range(1, 13))
    floor = [0.1, 0.05, *[0.036] * 10]
    assert [has_stalled(floor[: 2 + k]) for k in range(1, STALE + 2)] == [False] * STALE + [True]


def test_a_late_success_counts():
    assert not has_stalled([0.1, *[0.1] * (STALE - 1), 0.05])
    assert has_stalled([0.05, 0.1, *[0.047] * (STALE - 1)])


class NoLines:
    """A description without lines."""

    lines: dict = {}


@pytest.mark.parametrize("stalled", [True, False])
def test_a_set_that_has_stalled_has_ended_for_every_error(tmp_path, stalled):
    file = round_file(tmp_path, 0)
    file.parent.mkdir()
    file.write_text(json.dumps({"error": 0.03, "threshold": 0.0, "lines": {}, "stalled": stalled}))
    plan = Plan(tmp_path, NoLines())
    assert plan.ended(0.001) is stalled and plan.ended(0.05)
