"""What compiled code relies on in a surrogate: checked when a file is read, refused by name and limit."""

from __future__ import annotations

import numpy as np

from rom.checked_file import require
from rom.components import Components
from rom.separated.separated_form import Separated

MOST_PARAMETERS, MOST_REGIMES = 9, 64  # as in native/kernel.h
MOST_TERMS = 1 << 16  # of a form: with these, places in memory are counted in 32 bits
TIP, OUTPUTS = 3, 4  # components of the free form before heights, and of a regime's before its conditions


def check_sizes(model: Components) -> None:
    """Refuse a surrogate, also one that is being trained, beyond what compiled code holds.

    Raises:
        ModelError: one line that names what and its limit.
    """
    p, regimes = len(model.parameters), len(model.regimes)
    require(1 <= p <= MOST_PARAMETERS, f"parameters must be from 1 to {MOST_PARAMETERS}", p)
    require(regimes <= MOST_REGIMES, f"regimes must be at most {MOST_REGIMES}", regimes)


def check(model: Components) -> None:
    """Refuse a surrogate that compiled code cannot read.

    Raises:
        ModelError: one line that names what and its limit.
    """
    check_sizes(model)
    p = len(model.parameters)
    tensions = p - model.has_obstacle
    lower, upper = model.limits
    ordered = bool(np.isfinite([lower, upper]).all() and (lower < upper).all())
    require(ordered, "parameters must have finite lower ends below their upper ends", [lower.tolist(), upper.tolist()])
    require(0 <= model.lead < tensions, f"lead must be from 0 to {tensions - 1}", model.lead)
    _form("free", model.free, tensions, TIP + model.has_obstacle, None)
    for name in ("tip", "displacement", "touch_distance", "margin"):
        value = getattr(model.errors, name)
        require(0 <= value < np.inf or np.isnan(value), f"error of {name} must be at least 0", value)
    geometry = model.scene["geometry"]
    lengths = [geometry["side"], geometry["plate"], *geometry["segments"]]
    positive = len(lengths) > 2 and all(isinstance(one, (int, float)) and 0 < one < np.inf for one in lengths)
    require(positive, "geometry must have a side, a plate and segments of finite lengths above 0 m", lengths)
    offsets = [one["offset"] for one in model.scene["tendons"]]
    require(np.shape(offsets) == (tensions, 2), f"tendons must be {tensions}, each with two offsets", np.shape(offsets))
    if model.has_obstacle:
        _contact(model, p)
    _field(model, tensions, p)


def _contact(model: Components, p: int) -> None:
    regimes, heights = len(model.regimes), len(model.free.modes) - TIP
    require(regimes >= 1, "regimes must be at least 1 with an obstacle", regimes)
    cells = len(model.regime_lookup)
    side = round(cells ** (1 / p))
    require(cells > 0 and side**p == cells, f"map must have as many cells along each of {p} parameters", cells)
    known = model.regime_lookup.min() >= 0 and model.regime_lookup.max() < regimes
    require(known, f"map must be of regimes 0 to {regimes - 1}", int(model.regime_lookup.max()))
    require(len(model.possible_regimes) == cells, f"near must have {cells} cells", len(model.possible_regimes))
    shape = (cells, 3 + model.has_pad)
    require(model.errors.contact.shape == shape, f"error must have shape {shape}", model.errors.contact.shape)
    require(not (model.errors.contact < 0).any(), "error must be at least 0", "others")
    soft = model.coordinates.soft
    require(0 < soft < np.inf and np.isfinite(model.coordinates.nearest), "soft must be finite and above 0 m", soft)
    for r, regime in enumerate(model.regimes):
        name, conditions = f"regime_{r}", len(regime.sizes)
        require(0 <= regime.corner < heights, f"corner of {name} must be from 0 to {heights - 1}", regime.corner)
        sizes = np.asarray(regime.sizes, float)
        require(
            bool(((sizes > 0) & (sizes < np.inf)).all()), f"sizes of {name} must be finite and above 0", sizes.tolist()
        )
        _form(name, regime.form, p, OUTPUTS + conditions + model.has_pad, OUTPUTS + conditions + model.has_pad)


def _form(name: str, form: Separated, axes: int, least: int, most: int | None) -> None:
    """A separated form of so many axes, with `least` components or more, but `most` at most."""
    require(len(form.factors) == axes == len(form.slopes), f"{name} must have {axes} axes", len(form.factors))
    require(form.modes.ndim == 2, f"modes of {name} must have shape (components, terms)", form.modes.shape)
    components, terms = form.modes.shape
    enough = least <= components and (most is None or components <= most)
    require(enough, f"{name} must have {least} components" + (" or more" if most is None else ""), components)
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


def _field(model: Components, tensions: int, p: int) -> None:
    moved = model.displacements
    if moved is None:
        return
    rows = 3 * len(model.nodes)
    require(model.nodes.shape == (rows // 3, 3) and rows > 0, "nodes must have shape (nodes, 3)", model.nodes.shape)
    bases = [("free", moved.free_basis, [("free displacement", moved.free, tensions)])]
    if moved.contact_basis is not None:
        forms = [(f"displacement in regime_{r}", form, p) for r, form in enumerate(moved.regimes)]
        bases.append(("contact", moved.contact_basis, forms))
    require(len(moved.regimes) == len(model.regimes), "displacements must be of every regime", len(moved.regimes))
    for name, basis, forms in bases:
        known = basis.ndim == 2 and len(basis) == rows and bool(np.isfinite(basis).all())
        require(known, f"{name}_basis must be finite, of shape ({rows}, modes)", basis.shape)
        for of, form, axes in forms:
            _form(of, form, axes, basis.shape[1], basis.shape[1])
