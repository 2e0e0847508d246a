"""Checks of arguments: messages name the argument, its rule with the unit, and the value."""

from typing import Any

import numpy as np


def number(
    name: str, value: Any, lowest: float, unit: str = "-", *, highest: float = np.inf, infinite: bool = False
) -> float:
    """Return a number of at least `lowest` and at most `highest`; infinity only if `infinite`.

    Raises:
        ValueError: the value is not a number in this range.
    """
    most = highest if infinite or highest < np.inf else np.finfo(float).max
    if _is_number(value) and lowest <= value <= most:
        return float(value)
    rule = f"of at least {lowest:g}" if highest == np.inf else f"from {lowest:g} to {highest:g}"
    raise ValueError(f"{name} must be a {_kind(infinite)} {rule}{_shown(unit)}, got {value!r}")


def positive(name: str, value: Any, unit: str = "-", *, infinite: bool = False) -> float:
    """Return a number above 0; infinity only if `infinite`.

    Raises:
        ValueError: the value is not a number above 0.
    """
    if _is_number(value) and 0 < value <= (np.inf if infinite else np.finfo(float).max):
        return float(value)
    raise ValueError(f"{name} must be a {_kind(infinite)} above 0{_shown(unit)}, got {value!r}")


def numbers(name: str, value: Any, shape: tuple[int | None, ...], unit: str) -> np.ndarray:
    """Return a copy of finite numbers of a shape, whose None is any length.

    Raises:
        ValueError: the value has another shape, or entries that are not finite numbers.
    """
    try:
        array = np.array(value, float) if not isinstance(value, str) and not np.iscomplexobj(value) else None
    except (TypeError, ValueError):
        array = None
    wanted = str(shape).replace("None", "n")
    if array is None or not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite numbers [{unit}] of shape {wanted}, got {_short(value)}")
    if array.ndim != len(shape) or any(w not in (None, s) for w, s in zip(shape, array.shape, strict=True)):
        raise ValueError(f"{name} must be finite numbers [{unit}] of shape {wanted}, got shape {array.shape}")
    return array


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def _shown(unit: str) -> str:
    return "" if unit == "-" else f" {unit}"


def _kind(infinite: bool) -> str:
    return "number" if infinite else "finite number"


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) < 60 else f"{type(value).__name__} of shape {np.shape(value)}"
