"""Contact regimes: their codes, what follows when a condition fails, and the conditions' derivatives."""

from collections import Counter

import numpy as np
import pytest

from rom.snapshots import contact_regimes
from rom.snapshots.contact_regimes import Sign

CORNER, EDGE, FACE, ARCH = (1, 1, 1, -1, 0), (1, 1, 1, 0, 0), (1, 1, 0, 0, 0), (1, 1, 1, -1, 1)
COUNTS = Counter({CORNER: 50, EDGE: 20, FACE: 5, ARCH: 8})
LISTED = list(COUNTS)


def test_only_a_plate_that_stands_on_one_corner_alone_is_a_corner():
    assert contact_regimes.corner(CORNER, half=False) == (0, (1, 1, -1))
    assert contact_regimes.corner(EDGE, half=False) is None
    assert contact_regimes.corner(EDGE, half=True) == (0, (1, 1, 0))
    assert contact_regimes.corner(ARCH, half=False) is None
    two = (0, 0, 0, 0, 1, 1, -1, 1, 0, 0)
    assert contact_regimes.corner(two, half=False) == (1, (1, -1, 1))


def test_a_regime_is_described_by_what_carries_and_its_ends():
    assert contact_regimes.describe(CORNER) == "contact by plate 1's corner (+x, +y, -z)"
    assert contact_regimes.describe(EDGE) == "contact by plate 1's edge (+x, +y)"
    assert contact_regimes.describe(FACE) == "contact by plate 1's face (+x)"
    assert contact_regimes.describe(ARCH) == "contact by plate 1's corner (+x, +y, -z) and segment 1's rubber"
    assert (
        contact_regimes.describe((0, 0, 0, 0, 1, -1, 0, 0, 1, 0))
        == "contact by plate 2's face (-x) and segment 1's rubber"
    )
    assert contact_regimes.describe((0,) * 5) == "no contact"


def test_every_condition_leads_to_the_regime_that_differs_by_what_failed():
    found = dict(zip(LISTED, contact_regimes.signs(LISTED, COUNTS), strict=True))
    assert {(sign.kind, sign.axis, LISTED[sign.target]) for sign in found[CORNER]} == {
        ("tilt", 2, EDGE),
        ("rubber_gap", 0, ARCH),
    }
    assert {(sign.kind, sign.axis, sign.end, LISTED[sign.target]) for sign in found[EDGE]} == {
        ("tilt", 1, 1, FACE),
        ("centre", 2, -1, CORNER),
    }
    assert [(sign.kind, LISTED[sign.target]) for sign in found[ARCH]] == [("rubber_force", CORNER)]


def test_a_regime_without_a_corner_goes_by_one_it_shares():
    corners = Counter({(0, (1, 1, -1)): 50, (0, (1, -1, -1)): 90})
    assert contact_regimes.nearest_corner(EDGE, corners) == (0, (1, 1, -1))
    assert contact_regimes.nearest_corner(FACE, corners) == (0, (1, -1, -1))


def state(x):
    """A made-up state that depends smoothly on two parameters, the last of them d."""
    a, d = x
    tilt = np.array([0.1, 0.5 + 0.2 * a, -0.3 + 0.1 * a * d])
    return {
        "parameters": np.array([a, d]),
        "contact_force": 3.0 + a - 5 * d,
        "plate_height": np.array([0.01 * a]),
        "plate_tilt": tilt[None],
        "plate_force": np.array([2.0 + 0.5 * a - 3 * d]),
        "centre_of_pressure": np.array([[0.2 * a, 0.1 + d, -0.4 * a * d]]),
        "rubber_reach": np.array([0.004 * a * a]),
    }


@pytest.mark.parametrize(
    "sign",
    [
        Sign(kind="tilt", segment=0, axis=2, end=-1),
        Sign(kind="centre", segment=0, axis=1, end=1),
        Sign(kind="force", segment=0),
        Sign(kind="gap", segment=0),
        Sign(kind="rubber_force", segment=0),
        Sign(kind="rubber_gap", segment=0),
    ],
    ids=lambda sign: sign.kind,
)
def test_derivatives_of_conditions_are_differences(sign):
    at, sizes, steps = np.array([1.2, 0.02]), np.array([0.0005, 0.005, 0.005]), 1e-6 * np.eye(2)

    def values(x):
        flat = {name: np.asarray(value)[None] for name, value in state(x).items()}
        names = [name for name in flat if name != "parameters"]
        slopes = {
            f"{name}_jacobian": np.stack(
                [(np.asarray(state(x + h)[name]) - np.asarray(state(x - h)[name])) / 2e-6 for h in steps], axis=-1
            )[None]
            for name in names
        }
        return contact_regimes.sign_values(sign, flat | slopes, sizes)

    slope = values(at)[1][0]
    differences = [(values(at + h)[0][0] - values(at - h)[0][0]) / 2e-6 for h in steps]
    assert slope == pytest.approx(differences, rel=1e-5, abs=1e-7)
