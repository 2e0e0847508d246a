"""Elements that cannot be are refused: every field of the bundled ones, broken one by one."""

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

import rom
from rom.elements.limits import check
from rom.files.checked_file import ModelError

ELEMENTS = rom.load().rod.elements
NAN, INF = float("nan"), float("inf")


def law(kind: str, **fields):
    """The elements with other fields of one law."""
    return replace(ELEMENTS, laws=ELEMENTS.laws | {kind: replace(ELEMENTS.laws[kind], **fields)})


def outline(kind: str, **fields):
    return replace(ELEMENTS, outlines=ELEMENTS.outlines | {kind: replace(ELEMENTS.outlines[kind], **fields)})


def polynomial(kind: str, **fields):
    return law(kind, polynomial=replace(ELEMENTS.laws[kind].polynomial, **fields))


def of(kind: str):
    return ELEMENTS.laws[kind]


def coefficients(polynomial, value: float):
    """A polynomial with another first coefficient."""
    values = polynomial.coefficients.copy()
    values[0, 0] = value
    return replace(polynomial, coefficients=values)


def without_constant():
    """An outline whose products all change with loads."""
    own = ELEMENTS.outlines["interior"].polynomial
    kept = own.powers[:, :-1].any(axis=1)
    shorter = replace(own, powers=own.powers[kept], coefficients=own.coefficients[kept])
    return outline("interior", polynomial=shorter)


SHORTEST = of("interior").lengths[0]
BROKEN = {
    "force must be finite and above 0 N, got 0": lambda: replace(ELEMENTS, force=0.0),
    "force must be finite and above 0 N, got nan": lambda: replace(ELEMENTS, force=NAN),
    "elements must be clamp, plate and interior": lambda: replace(ELEMENTS, laws={"plate": of("plate")}),
    "lengths of interior must be finite and above 0 m": lambda: law("interior", lengths=(SHORTEST, SHORTEST / 2)),
    "lengths of plate must be equal": lambda: law("plate", lengths=(0.01, 0.02)),
    "tension_map of clamp must have shape": lambda: law("clamp", tension_map=np.eye(3)),
    "tension_map of clamp must be finite": lambda: law("clamp", tension_map=np.full((2, 2), INF)),
    "tensions of plate must have finite lowest ones": lambda: law("plate", tensions=np.zeros((2, 2))),
    "box of clamp must have shape": lambda: polynomial("clamp", lower=of("clamp").polynomial.lower[1:]),
    "box of clamp must have finite lower ends": lambda: polynomial("clamp", upper=of("clamp").polynomial.lower),
    "powers of plate must have shape": lambda: polynomial("plate", powers=of("plate").polynomial.powers[:, 1:]),
    "powers of plate must be at least 0": lambda: polynomial("plate", powers=-of("plate").polynomial.powers),
    "coefficients of interior must have shape": lambda: polynomial("interior", coefficients=np.zeros((1, 1))),
    "coefficients of clamp must be finite": lambda: law("clamp", polynomial=coefficients(of("clamp").polynomial, NAN)),
    "coefficients of variants of plate must be finite": lambda: law(
        "plate", deviations=coefficients(of("plate").deviations, INF)
    ),
    "half of outline of plate must be finite and above 0 m": lambda: outline("plate", half=np.zeros(2)),
    "half of outline of plate must be the section's": lambda: outline("plate", half=np.array([0.005, 0.004])),
    "error of outline of clamp must be finite and at least 0 m": lambda: outline("clamp", error=-1e-9),
    "powers of outline of interior must have a product of the distance alone": without_constant,
    "error_factors must be finite and above 0": lambda: replace(ELEMENTS, error_factors={"tip": INF}),
}


def test_the_bundled_elements_keep_all_rules_at_any_size_and_modulus():
    check(ELEMENTS)
    check(ELEMENTS.scaled(20.0, 0.1))


@pytest.mark.parametrize("message", BROKEN)
def test_one_broken_field_is_refused_by_its_name_and_rule(message):
    with pytest.raises(ModelError) as refused:
        check(BROKEN[message]())
    assert str(refused.value).startswith(message) and "\n" not in str(refused.value)


@pytest.mark.parametrize("quantity", ["contact_force", "free_place_m"])
@pytest.mark.parametrize("value", [None, -1e-9, NAN, INF, "small", [1.0]])
def test_an_error_of_left_out_lines_must_be_a_number_of_0_or_more(quantity, value):
    provenance = deepcopy(ELEMENTS.provenance)
    provenance["left_out"][quantity]["median"] = 0.0
    check(replace(ELEMENTS, provenance=provenance))
    provenance["left_out"][quantity]["median"] = value
    with pytest.raises(ModelError, match=f"left_out of provenance must have the median of {quantity}, finite"):
        check(replace(ELEMENTS, provenance=provenance))


@pytest.mark.parametrize("provenance", [None, [], {"left_out": 3}, {"left_out": {"contact_force": 0.1}}])
def test_provenance_that_is_no_mapping_is_refused_and_does_not_end_in_a_traceback(provenance):
    with pytest.raises(ModelError, match="left_out of provenance must have the median of contact_force"):
        check(replace(ELEMENTS, provenance=provenance))
