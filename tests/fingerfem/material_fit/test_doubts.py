"""Wrong units and columns, preloads and points after a break are named; tests without them are not."""

import re
from dataclasses import replace

import numpy as np
import pytest
from material_fit.synthetic import KNOWN, MODES, measured

from fingerfem.material_fit.doubts import doubts
from fingerfem.material_fit.fit import compare
from fingerfem.material_fit.measurements import Measurement
from fingerfem.material_fit.report import as_json, lines


def test_tests_of_rubbers_leave_no_doubt():
    for seed, (name, law) in enumerate(KNOWN.items()):
        assert doubts(measured(law, MODES, noise=0.01, seed=seed), None) == []
        if name != "ogden":
            assert compare(measured(law, ["uniaxial"], noise=0.01), [name]).doubts == []


ONE = measured(KNOWN["ogden"], ["uniaxial"])[0]
BROKEN = np.where(ONE.stretch > 1.9, 0.1 * ONE.stress, ONE.stress)
DOUBTED: dict[str, tuple[Measurement, str]] = {
    "kPa as MPa": (replace(ONE, stress=1e3 * ONE.stress), r"unit of stress: .* from 10 to 50000 kPa, this has"),
    "strain as stretch": (
        replace(ONE, stretch=ONE.stretch + 1),
        "stretch or strain: uniaxial data begin at a strain of 1.02",
    ),
    "fractions as percent": (replace(ONE, stretch=1 + 0.01 * (ONE.stretch - 1)), "unit of strain: .* is 1 %"),
    "preload": (replace(ONE, stress=ONE.stress + 0.2 * ONE.peak), r"preload: the uniaxial stress at rest, .* kPa$"),
    "break": (replace(ONE, stress=BROKEN), r"points: no law is nearer than \d+ % of the peak stress"),
}


@pytest.mark.parametrize("name", DOUBTED)
def test_what_is_unlikely_is_named_with_its_value(name, tmp_path):
    measurement, rule = DOUBTED[name]
    found = compare([measurement], ["neo-hookean", "yeoh"])
    (line,) = [one for one in found.doubts if re.search(rule, one)]
    assert line.startswith("check ") and line in lines(found) and line in as_json(found, tmp_path)["doubts"]


def test_no_law_is_chosen_for_stress_that_falls():
    found = compare([replace(ONE, stress=ONE.stress[::-1])], ["neo-hookean", "yeoh"])
    assert found.chosen is None and "no law is usable: the errors of all exceed 20 % of the peak stress" in lines(found)
    assert any("no law is nearer than" in one for one in found.doubts)
