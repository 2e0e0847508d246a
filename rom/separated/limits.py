"""What compiled code relies on in a separated model: checked when a file is read, refused by name and limit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rom.checked_file import require
from rom.separated.separated_form import Separated

if TYPE_CHECKING:
    from rom.separated.model import SeparatedModel

MOST_PARAMETERS = 9  # as in native/kernel.h
MOST_TERMS = 1 << 16  # of a form: with these, places in memory are counted in 32 bits
FREE, CONTACT = 4, 4  # components of the free form, and of contact's without the pad


def check_sizes(model: SeparatedModel) -> None:
    """Refuse a model, also one that is being made, beyond the limits of compiled code.

    Raises:
        ModelError: one line that names what and its limit.
    """
    p = len(model.parameters)
    require(2 <= p <= MOST_PARAMETERS, f"parameters must be from 2 to {MOST_PARAMETERS}", p)


def check(model: SeparatedModel) -> None:
    """Refuse a model that compiled code cannot read.

    Raises:
        ModelError: one line that names what and its limit.
    """
    check_sizes(model)
    p = len(model.parameters)
    lower, upper = model.limits
    ordered = bool(np.isfinite([lower, upper]).all() and (lower < upper).all())
    require(ordered, "parameters must have finite lower ends below their upper ends", [lower.tolist(), upper.tolist()])
    require(0 <= model.lead < p - 1, f"lead must be from 0 to {p - 2}", model.lead)
    _form("free", model.free, p - 1, FREE, FREE)
    _form("contact", model.contact, p, CONTACT, CONTACT + 1)
    _cells(model, p)
    _scene(model, p - 1)
    if model.displacements is not None:
        _field(model)


def _cells(model: SeparatedModel, p: int) -> None:
    cells = len(model.answered)
    require(cells > 0 and model.cells**p == cells, f"cells must be as many along each of {p} parameters", cells)
    errors, shape = model.errors, (cells, 3 + model.has_pad)
    require(errors.contact.shape == shape, f"error must have shape {shape}", errors.contact.shape)
    require(not (errors.contact < 0).any(), "error must be at least 0", "others")
    for name in ("tip", "displacement", "touch_distance", "margin"):
        value = getattr(errors, name)
        require(0 <= value < np.inf or np.isnan(value), f"error of {name} must be at least 0", value)
    soft = model.coordinates.soft
    require(0 < soft < np.inf and np.isfinite(model.coordinates.nearest), "soft must be finite and above 0 m", soft)


def _scene(model: SeparatedModel, tensions: int) -> None:
    geometry = model.scene["geometry"]
    lengths = [geometry["side"], geometry["plate"], *geometry["segments"]]
    positive = len(lengths) > 2 and all(isinstance(one, (int, float)) and 0 < one < np.inf for one in lengths)
    require(positive, "geometry must have a side, a plate and segments of finite lengths above 0 m", lengths)
    offsets = [one["offset"] for one in model.scene["tendons"]]
    require(np.shape(offsets) == (tensions, 2), f"tendons must be {tensions}, each with two offsets", np.shape(offsets))


def _form(name: str, form: Separated, axes: int, least: int, most: int) -> None:
    """A separated form of so many axes, with `least` to `most` components."""
    require(len(form.factors) == axes == len(form.slopes), f"{name} must have {axes} axes", len(form.factors))
    require(form.modes.ndim == 2, f"modes of {name} must have shape (components, terms)", form.modes.shape)
    components, terms = form.modes.shape
    require(least <= components <= most, f"{name} must have {least} to {most} components", components)
    require(1 <= terms <= MOST_TERMS, f"{name} must have from 1 to {MOST_TERMS} terms", terms)
    for a, (factor, slope) in enumerate(zip(form.factors, form.slopes, strict=True)):
        shape = factor.shape
        known = len(shape) == 2 and shape[0] >= 2 and shape[1] == terms and slope.shape == shape
        require(known, f"values_{a} and slopes_{a} of {name} must have shape (nodes, {terms})", (shape, slope.shape))
    require(
        form.finite and bool((form.lower < form.upper).all()), f"{name} must be finite on axes of some length", "others"
    )
    require(form.errors.shape == (terms,), f"errors of {name} must have shape ({terms},)", form.errors.shape)
    require(
        form.lost.shape == (terms, components), f"lost of {name} must have shape {terms, components}", form.lost.shape
    )


def _field(model: SeparatedModel) -> None:
    moved = model.displacements
    assert moved is not None
    rows = 3 * len(moved.nodes)
    require(moved.nodes.shape == (rows // 3, 3) and rows > 0, "nodes must have shape (nodes, 3)", moved.nodes.shape)
    known = moved.basis.ndim == 2 and len(moved.basis) == rows and bool(np.isfinite(moved.basis).all())
    require(known, f"basis must be finite, of shape ({rows}, modes)", moved.basis.shape)
    for name, amounts, form in (("free", moved.free, model.free), ("contact", moved.contact, model.contact)):
        shape = (moved.basis.shape[1], form.terms)
        fits = amounts.shape == shape and bool(np.isfinite(amounts).all())
        require(fits, f"displacement by {name} must be finite, of shape {shape}", amounts.shape)
