"""A finger of rod elements before one object as a source: as many samples as wanted, in seconds."""

from dataclasses import replace
from typing import Any

import numpy as np

from rom.answer import FORCE, TOUCH, Answer
from rom.console.terminal import Progress, quiet
from rom.dataset.sections.section import top
from rom.error_statistics import compared, differences
from rom.files.checked_file import require
from rom.parameter import joined
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
        ModelError: fewer than 4 nodes, too narrow a range of d, or an object that is not in the way of the finger.
    """
    length, p = sum(model.scene["geometry"]["segments"]), len(model.parameters)
    (nearest, farthest), least = model.obstacle.distances, NARROWEST * length
    require(nodes >= 4, "nodes must be at least 4", nodes)
    rule = f"d must have a range of at least {least:g} m"
    require(farthest - nearest >= least, rule, f"{nearest:g} to {farthest:g} m")
    wide = replace(model, obstacle=replace(model.obstacle, distances=(nearest, max(farthest, length))))

    def sampled(tensions: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        answer = wide.answers(joined(tensions, d).reshape(-1, p))
        good = (answer.evaluations > 0) & (answer.out[:, FORCE] < BEYOND * model.rod.force)
        values, jacobians = np.where(good, answer.out.T, np.nan).T, np.where(good, answer.jacobians.T, np.nan).T
        return values.reshape(*d.shape, -1), jacobians.reshape(*d.shape, -1, p)

    axes = [np.linspace(one.lower, one.upper, nodes) for one in model.parameters[:-1]]
    s, tensions = np.linspace(FIRST, 1.0, nodes), np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    progress("sampling", 0, 2)
    free = sampled(tensions, np.full(tensions.shape[:-1], np.inf))
    touch = free[0][..., TOUCH]
    rule = "the object must be in the way of the finger at all tensions: narrow those of the scene, or ask the finger"
    require(not np.isinf(touch).any(), rule, f"a finger that passes it at {tensions[np.isinf(touch)][:1].tolist()} N")
    rule = f"d must begin below {np.nanmax(touch):.4g} m, where the finger touches"
    require(bool(np.nanmax(touch) > nearest), rule, f"{nearest:g} m")
    progress("sampling", 1, 2)
    contact = sampled(tensions[..., None, :], touch[..., None] - (touch[..., None] - nearest) * s)
    parameters, scene, axes = model.parameters, model.scene, [*axes, s]
    return Samples(parameters=parameters, scene=scene, axes=axes, free=free, contact=contact, determined=DETERMINED)


def specialise(
    model: TouchedSegment, nodes: int = NODES, options: EnrichmentOptions | None = None, *, progress: Progress = quiet
) -> SeparatedModel:
    """The separated model of a finger before its object, for tensions and d within the finger's limits.

    It states its error against the finger at random points. Estimated errors count the finger's own, and cells in which
    the finger has no answer within its limits are marked.

    Args:
        model: the finger and its object.
        nodes: of every axis, 4 at least; nodes^(tensions + 1) contacts are solved.
        options: of the separation.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        ModelError: fewer than 4 nodes, an object that is not in the way of the finger, or too few contacts.

    Example:
        >>> table = specialise(TouchedSegment.load(), nodes=12)  # doctest: +SKIP
    """
    table = tabulated(rod_samples(model, nodes, progress), options or EnrichmentOptions(), progress)
    progress("measuring the errors", 0, 2)
    points, own = _random(model, np.random.default_rng([0, 0]), CALIBRATING)
    off = differences(table.evaluate(points), {name: getattr(own, name) for name in QUANTITIES})
    off = {name: error + own.error[name] for name, error in off.items()}
    cells = int(CELLS ** (1 / points.shape[1]) + 1e-9)
    table = replace(table, errors=estimated(table, points, off, np.asarray(own.inside), cells))
    progress("measuring the errors", 1, 2)
    accuracy = measured(table, model, np.random.default_rng([0, 1]), MEASURING)
    rule = f"the table must have contact forces at {FEWEST} of {MEASURING} points at least"
    count = accuracy["contact_force"]["count"]
    require(count >= FEWEST, rule, f"{count}: all others are marked; take other distances or more nodes")
    plane = facing_plane(2 * top(model.scene), model.obstacle.distances)
    origin = {"specialised_from": model.scene["name"], "object": repr(model.obstacle)}
    provenance = table.provenance | origin | {"facing_plane": model.obstacle == plane}
    return replace(table, accuracy=accuracy, provenance=provenance)


def measured(
    table: SeparatedModel, model: TouchedSegment, random: np.random.Generator, count: int
) -> dict[str, dict[str, Any]]:
    """Errors against the finger at random points inside both, see `compared`; `decided`: the share of right touches."""
    points, own = _random(model, random, count)
    answers, true = table.evaluate(points), {name: getattr(own, name) for name in QUANTITIES}
    inside = np.asarray(own.inside & answers.inside)
    right = (answers.contact_force > 0) == (own.contact_force > 0)
    errors = compared(answers, true, differences(answers, true), inside)
    errors["touch_distance"]["decided"] = float(np.mean(right[inside]))
    return errors


def _random(model: TouchedSegment, random: np.random.Generator, count: int) -> tuple[np.ndarray, Answer]:
    """Points within the limits, shape (count, p), and what the finger answers."""
    lower, upper = model.limits
    points = lower + random.random((count, len(lower))) * (upper - lower)
    return points, model.evaluate(points)
