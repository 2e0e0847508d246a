"""Checks of elements that are read from a file: a fault is refused by name and rule."""

from typing import Any

import numpy as np

from rom.elements.elements import CLAMP, INTERIOR, PLATE, WHOLE, Elements
from rom.elements.law import POSE, ElementLaw
from rom.elements.outline import NUMBERS, OutlineLaw
from rom.elements.polynomial import Polynomial
from rom.files.checked_file import require

KINDS = ({CLAMP, PLATE}, {CLAMP, INTERIOR, PLATE}, {WHOLE})
WRENCH = 6
FACTORS = "error_factors must be finite and above 0"
# Errors of predicted left-out lines that are shown and used.
LEFT_OUT = (("contact_force", "median"), ("contact_force", "p95"), ("free_place_m", "median"), ("free_place_m", "p95"))


def check(elements: Elements) -> None:
    """Refuse elements of the wrong shapes, or with numbers that cannot be.

    Raises:
        ModelError: one line that names what and its rule.
    """
    t = elements.tensions
    require(set(elements.laws) in KINDS, "elements must be clamp, plate and interior, or whole", sorted(elements.laws))
    require(0 < elements.force < np.inf, "force must be finite and above 0 N", elements.force)
    for kind, law in elements.laws.items():
        _law(kind, law, t)
        _outline(f"outline of {kind}", elements.outlines[kind], t)
        half, box = elements.outlines[kind].half, elements.section.box
        require(np.allclose(half, box, rtol=1e-9), f"half of outline of {kind} must be the section's, {box}", half)
    alike = {law.deviations is None or law.deviations.coefficients.shape[1] for law in elements.laws.values()}
    require(len(alike) == 1, "variants must be as many of all laws, or none", sorted(map(str, alike)))
    factors = elements.error_factors
    usable = isinstance(factors, dict) and all(isinstance(one, (int, float)) for one in factors.values())
    require(usable and all(0 < one < np.inf for one in factors.values()), FACTORS, factors)
    _left_out(elements.provenance)


def _law(kind: str, law: ElementLaw, t: int) -> None:
    shortest, longest = law.lengths
    require(0 < shortest <= longest < np.inf, f"lengths of {kind} must be finite and above 0 m", law.lengths)
    require(kind == INTERIOR or not law.has_lengths, f"lengths of {kind} must be equal", law.lengths)
    _tensions(kind, law.tension_map, law.tensions, t)
    _polynomial(kind, law.polynomial, t + WRENCH + law.has_lengths, POSE + t)
    if law.deviations is not None:
        values = law.deviations.coefficients.shape[-1]
        require(values > 0 and values % POSE == 0, f"variants of {kind} must have {POSE} values each", values)
        _polynomial(f"variants of {kind}", law.deviations, t + WRENCH + law.has_lengths, values)


def _outline(name: str, law: OutlineLaw, t: int) -> None:
    ok = law.half.shape == (2,) and bool(((law.half > 0) & (law.half < np.inf)).all())
    require(ok, f"half of {name} must be finite and above 0 m, shape (2,)", law.half.tolist())
    require(0 <= law.error < np.inf, f"error of {name} must be finite and at least 0 m", law.error)
    _polynomial(name, law.polynomial, t + WRENCH + 1, NUMBERS)
    constant = bool((~law.polynomial.powers[:, :-1].any(axis=1)).any())
    require(constant, f"powers of {name} must have a product of the distance alone", "none")


def _tensions(name: str, tension_map: np.ndarray, tensions: np.ndarray, t: int) -> None:
    require(tension_map.shape == (t, t), f"tension_map of {name} must have shape {t, t}", tension_map.shape)
    require(bool(np.isfinite(tension_map).all()), f"tension_map of {name} must be finite", "others")
    ordered = tensions.shape == (2, t) and bool(np.isfinite(tensions).all() and (tensions[0] < tensions[1]).all())
    require(ordered, f"tensions of {name} must have finite lowest ones below the highest", tensions.tolist())


def _polynomial(name: str, polynomial: Polynomial, inputs: int, values: int) -> None:
    lower, upper, powers = polynomial.lower, polynomial.upper, polynomial.powers
    require(lower.shape == upper.shape == (inputs,), f"box of {name} must have shape {2, inputs}", lower.shape)
    ordered = bool(np.isfinite([lower, upper]).all() and (lower < upper).all())
    require(ordered, f"box of {name} must have finite lower ends below its upper ends", [*lower, *upper])
    known = powers.ndim == 2 and powers.shape[1] == inputs and len(powers) > 0
    require(known, f"powers of {name} must have shape (products, {inputs})", powers.shape)
    require(bool((powers >= 0).all()), f"powers of {name} must be at least 0", int(powers.min()))
    shape = len(powers), values
    coefficients = polynomial.coefficients
    require(coefficients.shape == shape, f"coefficients of {name} must have shape {shape}", coefficients.shape)
    require(bool(np.isfinite(coefficients).all()), f"coefficients of {name} must be finite", "others")


def _left_out(provenance: Any) -> None:
    for quantity, share in LEFT_OUT:
        known = provenance.get("left_out", {}) if isinstance(provenance, dict) else {}
        of = known.get(quantity, {}) if isinstance(known, dict) else {}
        value = of.get(share) if isinstance(of, dict) else None
        usable = isinstance(value, (int, float)) and 0 <= value < np.inf
        require(usable, f"left_out of provenance must have the {share} of {quantity}, finite and at least 0", value)
