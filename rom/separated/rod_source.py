"""A finger of rod elements before one object as a source: as many samples as wanted, in seconds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from rom.answer import FORCE, TOUCH, Answer
from rom.console.terminal import Progress, quiet
from rom.error_statistics import compared, differences
from rom.rod.objects.shapes import facing_plane
from rom.rod.rod import QUANTITIES
from rom.rod.touched_segment import TouchedSegment
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.errors import estimated
from rom.separated.model import SeparatedModel
from rom.separated.tabulated import Samples, tabulated

NODES = 32  # of every axis
FIRST = 1e-4  # node of s next to touch, where contact is as good as its limit [-]
NARROWEST = 1e-3  # range of d over the finger's length [-]
CELLS = 20_000  # of estimated errors and marks, at most
DETERMINED = 3.0  # values for every number of the separated form [-]
CALIBRATING, MEASURING = 30_000, 8_000  # random points that calibrate the estimated errors; others that measure them
FEWEST = 20  # of the latter with a contact force inside
BEYOND = 2.0  # forces over the largest trained one up to which answers support a table [-]


def rod_samples(model: TouchedSegment, nodes: int = NODES, progress: Progress = quiet) -> Samples:
    """A finger before its object, on a grid of so many nodes of every axis.

    Raises:
        ValueError: fewer than 4 nodes, or an object that is not in the way of the finger.
    """
    if nodes < 4:
        raise ValueError(f"nodes must be at least 4, got {nodes}")
    lower, upper = model.limits
    farthest = sum(model.scene["geometry"]["segments"])  # contact begins beyond the limits, too
    wide = replace(model, obstacle=replace(model.obstacle, distances=(lower[-1], max(upper[-1], farthest))))

    def sampled(tensions: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        points = np.concatenate([np.broadcast_to(tensions, (*d.shape, tensions.shape[-1])), d[..., None]], axis=-1)
        found = wide.answers(points.reshape(-1, len(lower)))
        good = (found.evaluations > 0) & (found.out[:, FORCE] < BEYOND * model.rod.force)
        parts = np.where(good[:, None], found.out, np.nan), np.where(good[:, None, None], found.jacobians, np.nan)
        return parts[0].reshape(*d.shape, -1), parts[1].reshape(*d.shape, -1, len(lower))

    ends = zip(lower[:-1], upper[:-1], strict=True)
    axes = [*(np.linspace(low, high, nodes) for low, high in ends), np.linspace(FIRST, 1.0, nodes)]
    tensions = np.stack(np.meshgrid(*axes[:-1], indexing="ij"), axis=-1)
    progress("sampling", 0, 2)
    free = sampled(tensions, np.full(tensions.shape[:-1], np.inf))
    touch = free[0][..., TOUCH]
    _check_distances(model, tensions, touch)
    progress("sampling", 1, 2)
    contact = sampled(tensions[..., None, :], touch[..., None] - np.multiply.outer(touch - lower[-1], axes[-1]))
    return Samples(
        parameters=model.parameters,
        scene=model.scene,
        lead=model.lead,
        axes=axes,
        free=free,
        contact=contact,
        determined=DETERMINED,
    )


def _check_distances(model: TouchedSegment, tensions: np.ndarray, touch: np.ndarray) -> None:
    """Raise ValueError for distances or an object that no model can be of."""
    least, (lower, upper) = NARROWEST * sum(model.scene["geometry"]["segments"]), model.obstacle.distances
    if not upper - lower >= least:
        raise ValueError(f"d must have a range of at least {least:g} m, got {lower:g} to {upper:g} m")
    if np.isinf(touch).any():
        raise ValueError(
            f"the object must be in the way of the finger at all tensions, but the finger passes it at "
            f"{tensions[np.isinf(touch)][0].tolist()} N: narrow the tensions of the scene, or ask the finger itself"
        )
    if np.nanmax(touch) <= lower:
        raise ValueError(f"d must begin below {np.nanmax(touch):.4g} m, where the finger touches, got {lower:g} m")


def specialise(
    model: TouchedSegment,
    nodes: int = NODES,
    options: EnrichmentOptions | None = None,
    *,
    seed: int = 0,
    progress: Progress = quiet,
) -> SeparatedModel:
    """The separated model of a finger before its object, for tensions and d within the finger's limits.

    It states its error against the finger at random points. Estimated errors count the finger's own, and cells in which
    the finger has no answer within its limits are marked.

    Args:
        model: the finger and its object.
        nodes: of every axis, 4 at least; nodes^(tensions + 1) contacts are solved.
        options: of the separation.
        seed: of the points at which errors are measured.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        ValueError: fewer than 4 nodes, or an object that is not in the way of the finger.

    Example:
        >>> table = specialise(TouchedSegment.load(), nodes=12)  # doctest: +SKIP
    """
    table = tabulated(rod_samples(model, nodes, progress), options or EnrichmentOptions(), progress)
    progress("measuring the errors", 0, 2)
    points, own = _random(model, np.random.default_rng([seed, 0]), CALIBRATING)
    off = differences(table.evaluate(points), {name: getattr(own, name) for name in QUANTITIES})
    off = {name: error + own.error[name] for name, error in off.items()}
    cells = int(CELLS ** (1 / points.shape[1]) + 1e-9)
    table = replace(table, errors=estimated(table, points, off, np.asarray(own.inside), cells))
    progress("measuring the errors", 1, 2)
    accuracy = measured(table, model, np.random.default_rng([seed, 1]), MEASURING)
    count = accuracy["contact_force"]["count"]
    if count < FEWEST:
        raise ValueError(
            f"the table must have contact forces at {FEWEST} of {MEASURING} points at least, got {count}: all others "
            "are marked; take other distances or more nodes"
        )
    origin = {
        "specialised_from": model.scene["name"],
        "object": repr(model.obstacle),
        "facing_plane": model.obstacle == facing_plane(model.scene["geometry"]["side"], model.obstacle.distances),
    }
    return replace(table, accuracy=accuracy, provenance=table.provenance | origin)


def measured(
    table: SeparatedModel, model: TouchedSegment, random: np.random.Generator, count: int
) -> dict[str, dict[str, Any]]:
    """Errors against the finger at random points inside both, see `compared`; `decided`: the share of right touches."""
    points, own = _random(model, random, count)
    answers, true = table.evaluate(points), {name: getattr(own, name) for name in QUANTITIES}
    inside = np.asarray(own.inside & answers.inside)
    right = (answers.contact_force > 0) == (own.contact_force > 0)
    found = compared(answers, true, differences(answers, true), inside)
    found["touch_distance"]["decided"] = float(np.mean(right[inside]))
    return found


def _random(model: TouchedSegment, random: np.random.Generator, count: int) -> tuple[np.ndarray, Answer]:
    """Points within the limits, shape (count, p), and what the finger answers."""
    lower, upper = model.limits
    points = lower + random.random((count, len(lower))) * (upper - lower)
    return points, model.evaluate(points)
