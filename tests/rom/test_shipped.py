"""The trained finger that comes with the repository."""

from pathlib import Path

import numpy as np
import pytest

from rom import Surrogate
from rom.surrogate import SHIPPED


@pytest.fixture(scope="module")
def shipped() -> Surrogate:
    return Surrogate.load()


def test_it_is_small_enough_to_track_and_of_the_standard_scene(shipped):
    assert SHIPPED.stat().st_size < 500_000
    assert shipped.scene["name"] == "standard" and shipped.scene["mesh"]["order"] == 2
    assert [one["name"] for one in shipped.parameters] == ["F1", "F2", "d"]


def test_its_error_was_measured_on_held_out_states(shipped):
    assert shipped.accuracy["contact_force"]["p95"] < 0.02
    assert shipped.accuracy["contact_force"]["median"] < 0.001


def test_it_is_the_demo_s_finger_on_a_better_mesh(shipped, surrogate):
    """The draft mesh errs by 3 % of the contact force in the median (docs/tradeoff.md)."""
    random = np.random.default_rng(7)
    lower, upper = shipped.limits
    points = lower + (upper - lower) * random.random((400, 3))
    ours, theirs = shipped.evaluate(points), surrogate.evaluate(points)
    felt = (ours.contact_force > 0.5) & (theirs.contact_force > 0.5)
    assert felt.sum() > 100
    assert np.median(np.abs(theirs.contact_force[felt] / ours.contact_force[felt] - 1)) < 0.06
    assert np.abs(ours.tip - theirs.tip).max() < 0.1 * np.abs(ours.tip).max()


def test_it_is_rebuilt_by_a_command_of_the_makefile():
    text = (Path(__file__).resolve().parents[2] / "Makefile").read_text()
    assert "\nmodel:\n" in text and f"-o rom/{SHIPPED.name}" in text
