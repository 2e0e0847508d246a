"""What compiled code relies on in a segment's map: checked when a file is read, refused by name and limit."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from rom.checked_file import require
from rom.fit.chebyshev import Polynomial
from rom.rod.wrench_products import padded

if TYPE_CHECKING:
    from rom.rod.native import Segment
    from rom.rod.rod import Rod

MOST_TENSIONS, MOST_POWER, MOST_ELEMENTS = 8, 31, 64  # as in native/segment.h
MOST_PRODUCTS = 1 << 20  # of a polynomial: with these, places in memory are counted in 32 bits
WRENCH, POSE, CORNERS, EDGES = 6, 7, 24, 12  # numbers of each; of the four edges' corners at a station
ELEMENT = 6  # numbers of an element's pose
TWICE = 2.0  # largest ratio of a fitted quaternion's length to 1, or of 1 to it [-]
STATIONS = 2  # of the rubber's edges, at least: a tangent needs two


def check_sizes(segment: Rod) -> None:
    """Refuse a map, also one that is being trained, beyond what compiled code holds.

    Raises:
        ModelError: one line that names what and its limit.
    """
    require(1 <= segment.tensions <= MOST_TENSIONS, f"tensions must be from 1 to {MOST_TENSIONS}", segment.tensions)
    known = {"powers": segment.pose, "corner_powers": segment.corners, "skin_powers": segment.skin}
    for name, polynomial in known.items():
        if polynomial is not None and polynomial.powers.size:
            ends = polynomial.powers.min(), polynomial.powers.max()
            within = ends[0] >= 0 and ends[1] <= MOST_POWER
            require(within, f"{name} must be from 0 to {MOST_POWER}", f"{ends[0]} to {ends[1]}")


def check_rod(segment: Segment) -> None:
    """Refuse a rod of elements beyond what compiled code holds.

    Raises:
        ModelError: one line that names what and its limit.
    """
    elements = segment.elements
    require(1 <= len(elements) <= MOST_ELEMENTS, f"elements must be from 1 to {MOST_ELEMENTS}", len(elements))
    first, t = elements[0], len(elements[0].lower) - WRENCH
    require(1 <= t <= MOST_TENSIONS, f"tensions must be from 1 to {MOST_TENSIONS}", t)
    laws, most = {id(one): one for one in elements}, 0
    for k, one in enumerate(laws.values()):
        _polynomial(f"powers of law {k}", one, t, ELEMENT)
        _ends(one, t)
        _alike("tensions of all elements", [one.lower[:t], one.upper[:t]], [first.lower[:t], first.upper[:t]])
        _, _, counts = padded(one.powers[:, t:])
        most = max(most, sum(counts) * len(np.unique(one.powers[:, :t], axis=0)))
    size = len(laws) * most
    require(size <= MOST_PRODUCTS, f"laws must have at most {MOST_PRODUCTS} products, all as the largest, padded", size)
    _surface(segment, t)
    for name, surface in (("corners", segment.corners), ("skin", segment.skin)):
        if surface is not None:
            _alike(f"{name} and the plate's element", [surface.lower, surface.upper], [first.lower, first.upper])


def _alike(name: str, one: list[np.ndarray], other: list[np.ndarray]) -> None:
    require(bool(np.array_equal(one, other)), f"{name} must have one box", [*map(np.ndarray.tolist, one)])


def check(segment: Rod) -> None:
    """Refuse a map that compiled code cannot read.

    Raises:
        ModelError: one line that names what and its limit.
    """
    check_sizes(segment)
    t, pose = segment.tensions, segment.pose
    _box(segment, t)
    _polynomial("powers", pose, t, POSE)
    _groups(pose.powers[:, t:])
    _poses(pose, t)
    _surface(segment, t)
    if segment.shortenings is not None:
        _polynomial("shortening_powers", segment.shortenings, t, t)
    _field(segment, t)
    _scene(segment, t)
    for name in ("force_error", "place_error", "place_error_by_force"):
        value = getattr(segment, name)
        require(0 <= value < np.inf, f"{name} must be finite and at least 0", value)
    factors = segment.finer_mesh_factors
    require(all(0 < one < np.inf for one in factors.values()), "finer_mesh_factors must be finite and above 0", factors)


def _surface(segment: Rod | Segment, t: int) -> None:
    """The plate's corners and the rubber's edges."""
    if segment.corners is not None:
        _polynomial("corner_powers", segment.corners, t, CORNERS)
    if segment.skin is not None:
        numbers = segment.skin.coefficients.shape[-1]
        whole = numbers % EDGES == 0 and numbers >= STATIONS * EDGES
        require(
            whole, f"skin_coefficients must be a multiple of {EDGES} numbers, of {STATIONS} stations at least", numbers
        )
        _polynomial("skin_powers", segment.skin, t, numbers)
        require(segment.skin_error >= 0, "skin_error must be at least 0 m", segment.skin_error)


def _ends(polynomial: Polynomial, t: int) -> None:
    lower, upper = polynomial.lower, polynomial.upper
    require(lower.shape == upper.shape == (t + WRENCH,), f"box must have shape (2, {t + WRENCH})", lower.shape)
    ordered = bool(np.isfinite([lower, upper]).all() and (lower < upper).all())
    require(ordered, "box must have finite lower ends below its upper ends", [lower.tolist(), upper.tolist()])
    even = bool(np.allclose(lower[t:], -upper[t:], rtol=1e-9))
    require(even, "box must be as wide to both sides of no wrench", [lower[t:].tolist(), upper[t:].tolist()])


def _box(segment: Rod, t: int) -> None:
    lower, upper = segment.pose.lower, segment.pose.upper
    _ends(segment.pose, t)
    ends = np.array([[float(one["lower"]), float(one["upper"])] for one in segment.parameters]).T
    require(
        bool(np.allclose(ends, [lower, upper], rtol=1e-9)), "parameters must have the ends of the box", ends.tolist()
    )
    names = [one["name"] for one in segment.parameters]
    require(all(isinstance(one, str) for one in names) and len({*names}) == len(names), "names must differ", names)


def _polynomial(name: str, polynomial: Polynomial, t: int, values: int) -> None:
    powers, coefficients = polynomial.powers, polynomial.coefficients
    require(
        powers.ndim == 2 and powers.shape[1] == t + WRENCH, f"{name} must have shape (k, {t + WRENCH})", powers.shape
    )
    require(1 <= len(powers) <= MOST_PRODUCTS, f"{name} must be from 1 to {MOST_PRODUCTS} products", len(powers))
    known = powers.min() >= 0 and powers.max() <= MOST_POWER
    require(known, f"{name} must be from 0 to {MOST_POWER}", f"{powers.min()} to {powers.max()}")
    shape = (len(powers), values)
    require(coefficients.shape == shape, f"coefficients of {name} must have shape {shape}", coefficients.shape)
    require(bool(np.isfinite(coefficients).all()), f"coefficients of {name} must be finite", "others")


def _groups(powers: np.ndarray) -> None:
    """Products of the wrench, shape (k, 6): each is one that stands before it, times a power of its last variable."""
    counts = Counter(map(tuple, powers.tolist()))
    nothing = (0,) * WRENCH
    require(nothing in counts, "powers must have a product without the wrench", "none")
    for group, count in counts.items():
        if group == nothing:
            continue
        last = max(k for k in range(WRENCH) if group[k])
        parent = (*group[:last], 0, *group[last + 1 :])
        known = counts.get(parent, 0) >= count
        require(known, "powers must have each product also without its last power of the wrench, as often", group)


def _poses(pose: Polynomial, t: int) -> None:
    """Quaternions are fitted as such: about of length 1, here where the free plate is at every end of the tensions."""
    ends = np.array([[k >> j & 1 for j in range(t)] for k in range(1 << t)], float)
    points = np.zeros((len(ends), t + WRENCH))
    points[:, :t] = pose.lower[:t] + ends * (pose.upper - pose.lower)[:t]
    with np.errstate(all="ignore"):
        lengths = np.linalg.norm(pose.value(points)[:, 3:], axis=1)
    known = bool(((lengths > 1 / TWICE) & (lengths < TWICE)).all())
    require(known, f"quaternions must have lengths from {1 / TWICE} to {TWICE}", lengths.tolist())


def _field(segment: Rod, t: int) -> None:
    field = segment.displacements
    if field is None:
        return
    nodes, modes = len(field.nodes), field.modes.shape[0] if field.modes.ndim else 0
    require(field.nodes.shape == (nodes, 3) and nodes > 0, "nodes must have shape (nodes, 3)", field.nodes.shape)
    require(field.mean.shape == (nodes, 3), f"field_mean must have shape ({nodes}, 3)", field.mean.shape)
    shape = (modes, 3 * nodes)
    require(field.modes.shape == shape, f"field_modes must have shape (modes, {3 * nodes})", field.modes.shape)
    _polynomial("field_powers", field.amounts, t, modes)
    for name, values in (("nodes", field.nodes), ("field_mean", field.mean), ("field_modes", field.modes)):
        require(bool(np.isfinite(values).all()), f"{name} must be finite", "others")


def _scene(segment: Rod, t: int) -> None:
    geometry, tendons = segment.scene["geometry"], segment.scene["tendons"]
    lengths = [geometry["side"], geometry["plate"], *geometry["segments"]]
    positive = len(lengths) > 2 and all(isinstance(one, (int, float)) and 0 < one < np.inf for one in lengths)
    require(positive, "geometry must have a side, a plate and segments of finite lengths above 0 m", lengths)
    require(len(tendons) == t, f"tendons must be {t}, as the tensions", len(tendons))
    offsets = [one["offset"] for one in tendons]
    known = np.shape(offsets) == (t, 2) and bool(np.isfinite(np.asarray(offsets, float)).all())
    require(known, "offset of every tendon must be two finite numbers", offsets)
