"""A rod before one object -> its separated form: the paper's equations 2 and 3, sampled at as many points as wanted.

The rod answers any object, at the cost of a contact solve. Where one object is all that a scene has, its answers are
sampled on a tensor grid of the tensions F and the contact-aligned coordinate s, and separated,

    u(F, d) = u_0(F) + p sum_i m_i G_i1(F_1) G_i2(F_2) ... H_i(s),   s = p / (D(F) - d_min + soft),   p = D(F) - d,

with u the tip's displacement and the contact force, u_0 the free answer, D the touch distance and p the path past it
(Chenevier et al., PLoS ONE 13(2): e0192052, 2018; `rom.fit.contact_coordinates`). The derivatives of the samples make
the one-dimensional functions cubic Hermite functions. A table states its error against the rod at random points, and
counts the rod's own estimate in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.ndimage import distance_transform_edt, maximum_filter

from rom.components import Errors, Regime
from rom.error_statistics import norm, statistics
from rom.fit.contact_coordinates import SOFT, ContactCoordinates
from rom.rod.touched_segment import TouchedSegment
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.separate import Samples, separated_samples
from rom.surrogate import Surrogate
from rom.terminal import Progress, quiet

NODES = 32  # of every axis
FINER = 0.03  # share of the tolerance that the free answer is separated to: contact begins where it says
TOLERANCE, TERMS = 1e-5, 100  # of the separation, by default [-]
FIRST = 1e-4  # node of s next to touch, where contact is as good as its limit [-]
PAST = 0.01  # by how much samples that support the table go past the nearest object [m]
RANDOM = 30_000  # points at which errors are measured; as many again calibrate the estimate
MARGIN = 1e-3  # share of the range of d: contact paths below which errors do not become smaller
COVERED = 0.97  # of the calibrating points [-]
BEYOND = 2.0  # forces over the largest trained one up to which samples support a table [-]
FELT = 0.1  # force below which a relative error says nothing [N]
MOST_CELLS = 250_000  # of the lookup of what is known


class Grid(NamedTuple):
    """Nodes in contact: tensions, then s.

    Attributes:
        axes: of every tension [N], and of s [-].
        coordinates: the contact-aligned ones.
        free: answers at the nodes of the tensions, shape (n, 5), and their derivatives, shape (n, 5, p).
    """

    axes: Sequence[np.ndarray]
    coordinates: ContactCoordinates
    free: tuple[np.ndarray, np.ndarray]


def specialise(
    model: TouchedSegment,
    nodes: int = NODES,
    options: EnrichmentOptions | None = None,
    *,
    seed: int = 0,
    progress: Progress = quiet,
) -> Surrogate:
    """The table of a finger before its object, for tensions and d within the finger's limits.

    Args:
        model: the finger and its object.
        nodes: of every axis, 4 at least; nodes^(tensions + 1) contacts are solved.
        options: of the separation.
        seed: of the points at which errors are measured.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        ValueError: fewer than 4 nodes, or an object that the finger does not reach.

    Example:
        >>> table = specialise(TouchedSegment.load(), nodes=12)  # doctest: +SKIP
    """
    if nodes < 4:
        raise ValueError(f"nodes must be at least 4, got {nodes}")
    options = options or EnrichmentOptions(tolerance=TOLERANCE, terms=TERMS)
    progress("sampling the finger", 0, 2)
    grid = _grid(model, nodes)
    progress("sampling the finger", 1, 2)
    contact = _contact(model, grid)
    progress("separating the samples", 0, 2)
    free = separated_samples(_free(grid), replace(options, tolerance=FINER * options.tolerance))
    progress("separating the samples", 1, 2)
    form = separated_samples(contact, options)
    p = len(model.parameters)
    cells = min(nodes, int(MOST_CELLS ** (1 / p))) ** p
    regime = Regime(code=(), corner=0, begins=True, states=len(contact.values), sizes=[], form=form)
    table = Surrogate(
        parameters=model.parameters,
        free=free,
        regimes=[regime],
        regime_lookup=np.zeros(cells, np.int64),
        possible_regimes=np.ones(cells, np.uint64),
        coordinates=grid.coordinates,
        errors=Errors(tip=0.0, displacement=0.0, touch_distance=0.0, contact=np.zeros((cells, 3)), margin=1.0),
        displacements=None,
        lead=model.lead,
        nodes=np.zeros((0, 3)),
        scene=model.scene,
        accuracy={},
        provenance={"states": len(contact.values), "specialised_from": model.scene["name"], "nodes": nodes},
    )
    progress("measuring the errors", 0, 2)
    table = _calibrated(table, model, np.random.default_rng([seed, 0]))
    progress("measuring the errors", 1, 2)
    return replace(table, accuracy=compared(table, model, np.random.default_rng([seed, 1])))


def _points(axes: Sequence[np.ndarray]) -> np.ndarray:
    """All nodes of axes, the last one fastest, shape (n, axes)."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def _grid(model: TouchedSegment, nodes: int) -> Grid:
    """The nodes, and the free answers there."""
    lower, upper = model.limits
    tensions = [np.linspace(low, high, nodes) for low, high in zip(lower[:-1], upper[:-1], strict=True)]
    points = _points(tensions)
    found = model.answers(np.column_stack([points, np.full(len(points), np.inf)]))
    touch = found.out[:, 4]
    if not np.isfinite(touch).all() or touch.max() <= lower[-1]:
        raise ValueError(
            f"the object must be in the way of the finger at all tensions, and nearer than {upper[-1]:g} m: "
            f"the finger touches it at d from {touch.min():.4g} to {touch.max():.4g} m"
        )
    nearest = float(lower[-1])
    reach = float(touch.max()) - nearest
    soft = max(SOFT * reach, 2 * max(nearest - float(touch.min()), 0.0))
    deepest = reach / (reach + soft)
    return Grid([*tensions, np.linspace(FIRST, deepest, nodes)], ContactCoordinates(nearest, soft), found[:2])


def _free(grid: Grid) -> Samples:
    """Tip and touch distance without contact [m]."""
    out, jacobian = grid.free
    values, gradient = out[:, [0, 1, 2, 4]], jacobian[:, [0, 1, 2, 4], :-1]
    return Samples(grid.axes[:-1], values, gradient, np.ones(len(values), bool), np.abs(values).max(axis=0))


def _contact(model: TouchedSegment, grid: Grid) -> Samples:
    """What contact adds to tip and force per length of its path, by tensions and s.

    Values v = (u - u_0) / p. Along an axis of the tensions d follows D: dd = (1 - s) dD and dp = s dD; along s the path
    grows by w = D - d_min + soft.
    """
    s, (free, slopes) = grid.axes[-1], grid.free
    n, m = len(free), len(s)
    touch, rising = free[:, 4], slopes[:, 4, :-1]
    whole = touch - grid.coordinates.nearest + grid.coordinates.soft
    path = s * whole[:, None]
    points = np.column_stack([np.repeat(_points(grid.axes[:-1]), m, axis=0), (touch[:, None] - path).ravel()])
    everywhere = replace(model.obstacle, distances=(float(points[:, -1].min()), float(touch.max())))
    found = replace(model, obstacle=everywhere).answers(points)
    out, jacobian = found.out[:, :4].reshape(n, m, 4), found.jacobians[:, :4].reshape(n, m, 4, -1)
    values = (out - np.column_stack([free[:, :3], np.zeros(n)])[:, None]) / path[..., None]
    alone = np.concatenate([slopes[:, :3, :-1], np.zeros((n, 1, rising.shape[1]))], axis=1)[:, None]
    along = s[None, :, None, None] * rising[:, None, None]
    by_tension = jacobian[..., :-1] + jacobian[..., -1:] * (rising[:, None, None] - along)
    gradient = np.empty_like(jacobian)
    gradient[..., :-1] = (by_tension - alone - values[..., None] * along) / path[..., None, None]
    gradient[..., -1] = -(jacobian[..., -1] + values) * (whole[:, None] / path)[..., None]
    supports = (found.evaluations > 0).reshape(n, m) & np.isfinite(out).all(axis=2)
    supports &= (out[..., 3] < BEYOND * model.rod.force) & (touch[:, None] - path > grid.coordinates.nearest - PAST)
    shape = tuple(map(len, grid.axes))
    return _continued(grid.axes, values.reshape(*shape, -1), gradient.reshape(*shape, 4, -1), supports.reshape(shape))


def _continued(axes: Sequence[np.ndarray], values: np.ndarray, gradient: np.ndarray, supports: np.ndarray) -> Samples:
    """Samples on a grid: a node that does not support the table takes the value of the nearest one that does.

    The table is marked there. Without a value, sums of products would be free there, and expensive to find.
    """
    nearest = tuple(distance_transform_edt(~supports, return_distances=False, return_indices=True))
    values, gradient = values[nearest], np.where(supports[..., None, None], gradient, 0.0)
    values, gradient = values.reshape(supports.size, -1), gradient.reshape(supports.size, values.shape[-1], -1)
    return Samples(axes, values, gradient, np.ones(len(values), bool), np.abs(values).max(axis=0))


def _random(table: Surrogate, random: np.random.Generator) -> np.ndarray:
    """Points over the table's limits, shape (RANDOM, p)."""
    lower, upper = table.limits
    return lower + random.random((RANDOM, len(lower))) * (upper - lower)


def _calibrated(table: Surrogate, model: TouchedSegment, random: np.random.Generator) -> Surrogate:
    """The table with its estimated errors: what it differs from the finger by, and what the finger estimates.

    Cells of the contact path in which the finger has no answer within its limits are marked as not known.
    """
    points = _random(table, random)
    truth, ours = model.evaluate(points), table.outputs(points)
    tip = norm(ours[:, :3] - truth.tip) + truth.error["tip"]
    force = np.abs(ours[:, 3] - truth.contact_force) + truth.error["contact_force"]
    touch = np.abs(ours[:, 4] - truth.touch_distance) + truth.error["touch_distance"]
    lower, upper = table.limits
    margin, good = MARGIN * float(upper[-1] - lower[-1]), np.asarray(truth.inside, bool)
    path = ours[:, 4] - points[:, -1]
    free, pressed = good & (path <= 0), path > 0
    own, side = _cells(table, points, ours[:, 4])
    unknown = _largest_around(own[pressed & ~good], np.ones((pressed & ~good).sum()), side, len(lower)) > 0
    rates = np.zeros((len(unknown), 3))
    free_tip = float(np.quantile(tip[free], COVERED)) if free.any() else 0.0
    pushed = pressed & good
    for column, errors in enumerate((np.maximum(tip - free_tip, 0.0), force)):
        rates[:, column] = _rates(own[pushed], errors[pushed] / (path[pushed] + margin), side, len(lower))
    rates[unknown] = np.inf
    errors = Errors(
        tip=free_tip,
        displacement=0.0,
        touch_distance=float(np.quantile(touch[good], COVERED)),
        contact=rates,
        margin=margin,
    )
    return replace(table, errors=errors, possible_regimes=(~unknown).astype(np.uint64))


def _cells(table: Surrogate, points: np.ndarray, touch: np.ndarray) -> tuple[np.ndarray, int]:
    """Cell of the lookup of every point, shape (n,), and how many cells an axis has."""
    p = points.shape[1]
    side = round(len(table.regime_lookup) ** (1 / p))
    lower, upper = table.limits
    shares = (points - lower) / (upper - lower)
    shares[:, -1] = table.coordinates.of(points, touch)[:, -1]
    index = np.clip((shares * side).astype(int), 0, side - 1)
    return np.ravel_multi_index(tuple(index.T), (side,) * p), side


def _rates(own: np.ndarray, rates: np.ndarray, side: int, p: int) -> np.ndarray:
    """By cell: the largest rate of it and its neighbours; where there is none, that which COVERED of all are below."""
    found = _largest_around(own, rates, side, p)
    return np.where(np.isfinite(found), found, np.quantile(rates, COVERED) if rates.size else 0.0)


def _largest_around(own: np.ndarray, values: np.ndarray, side: int, p: int) -> np.ndarray:
    """By cell, the largest of values in it and in its neighbours, -infinity if there is none, shape (side^p,)."""
    found = np.full((side,) * p, -np.inf)
    np.maximum.at(found.reshape(-1), own, values)
    return maximum_filter(found, size=3, mode="nearest").reshape(-1)


def compared(table: Surrogate, model: TouchedSegment, random: np.random.Generator) -> dict[str, dict[str, Any]]:
    """Errors of a table against its finger at random points that both answer, by quantity, see `statistics`.

    Those of tip and force are relative to themselves, those of the touch distance to the range of d; `decided` is the
    share of the points at which both touch, or neither does.
    """
    points = _random(table, random)
    truth, answer = model.evaluate(points), table.evaluate(points)
    both = np.asarray(truth.inside & answer.inside, bool)
    felt = both & (truth.contact_force > FELT)
    off = norm(answer.tip - truth.tip), np.abs(answer.contact_force - truth.contact_force)
    touch, ends = np.abs(answer.touch_distance - truth.touch_distance), table.limits
    reach = np.full(int(both.sum()), ends[1][-1] - ends[0][-1])
    force = statistics(off[1][felt], truth.contact_force[felt], answer.error["contact_force"][felt])
    return {
        "tip": statistics(off[0][both], norm(truth.tip)[both], answer.error["tip"][both]),
        "contact_force": force,
        "touch_distance": statistics(touch[both], reach, answer.error["touch_distance"][both])
        | {"decided": float(np.mean((answer.contact_force > 0)[both] == (truth.contact_force > 0)[both]))},
    }
