"""Variables of an FMU: their numbers are those of the C, each is its own, and too many are refused."""

import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from rom.export.fmu import variables
from rom.export.fmu.variables import FLAG, INPUTS, MOST_INPUTS, OUTPUTS, REPORT, REPORT_ERRORS, STATUS, model_interface
from rom.files.checked_file import ModelError
from rom.native import LIBRARY
from rom.parameter import Parameter

NATIVE = Path(variables.__file__).parent / "native"


def table_like(tendons: int, has_obstacle: bool = True, has_pad: bool = False):
    """Attributes that an interface reads of a separated model."""
    parameters = [Parameter(f"F{k + 1}", "N", 1.0, 9.0) for k in range(tendons)]
    parameters += [Parameter("d", "m", 0.001, 0.03)] if has_obstacle else []
    return SimpleNamespace(
        parameters=parameters, has_obstacle=has_obstacle, has_pad=has_pad, scene={"name": "a <finger> & more"}
    )


def test_value_references_and_room_are_those_of_the_c():
    text = (NATIVE / "fmu.h").read_text()
    known = {name: int(value) for name, value in re.findall(r"\bFMU_(\w+) = (\d+)", text)}
    assert (known["INPUTS"], known["OUTPUTS"], known["FLAG"], known["STATUS"]) == (INPUTS, OUTPUTS, FLAG, STATUS)
    assert known["MOST_INPUTS"] == MOST_INPUTS and OUTPUTS + known["MOST_OUTPUTS"] <= FLAG
    rows = LIBRARY.constants  # a report is behind an answer and its errors, its own errors are behind all it may have
    assert REPORT - OUTPUTS == rows.FINGERFEM_MOST_ROWS + rows.FINGERFEM_MOST_ERRORS
    assert REPORT_ERRORS - REPORT == rows.FINGERFEM_QUATERNION + rows.FINGERFEM_MOST_TENSIONS
    assert OUTPUTS + known["MOST_OUTPUTS"] >= REPORT_ERRORS + rows.FINGERFEM_REPORT_ERRORS


@pytest.mark.parametrize("has_obstacle", [True, False])
@pytest.mark.parametrize("has_pad", [True, False])
def test_every_variable_has_a_name_and_a_number_of_its_own(model, has_obstacle, has_pad):
    for one in (model, table_like(3, has_obstacle, has_pad)):
        found = model_interface(one).variables
        assert len({each.name for each in found}) == len({each.reference for each in found}) == len(found)
        assert [each.reference for each in found if each.causality == "input"] == list(
            range(1, len(one.parameters) + 1)
        )
    names = {each.name for each in found}
    assert ("contact_force" in names) == has_obstacle and ("pad_pressure_error" in names) == has_pad
    assert "orientation_w" not in names


def test_tensions_start_at_none_and_the_object_far_away_within_their_ranges():
    for one, parameter in zip(model_interface(table_like(2)).of("input"), table_like(2).parameters, strict=True):
        assert one.start == (parameter.upper if parameter.unit == "m" else parameter.lower)
        assert (one.lower, one.upper, one.unit) == (parameter.lower, parameter.upper, parameter.unit)


def test_a_finger_reports_a_quaternion_and_the_shortening_of_every_tendon(model):
    found = {one.name: one for one in model_interface(model).of("output")}
    assert [found[f"orientation_{axis}"].reference - REPORT for axis in "wxyz"] == [0, 1, 2, 3]
    assert [found[f"shortening_{name}"].reference - REPORT for name in model.names[:-1]] == [4, 5]
    jumps = {name for name, one in found.items() if one.discrete}
    assert jumps == {name for name in found if name.endswith("_error")} | {"inside", "status"}


def test_more_parameters_than_there_is_room_for_are_refused():
    assert len(model_interface(table_like(MOST_INPUTS - 1)).of("input")) == MOST_INPUTS
    with pytest.raises(ModelError, match=f"at most {MOST_INPUTS} parameters for an FMU, got {MOST_INPUTS + 1}"):
        model_interface(table_like(MOST_INPUTS))
