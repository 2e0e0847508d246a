"""Samples on a tensor grid -> a table: the paper's equations 2 and 3 in contact-aligned coordinates.

A source answers at tensions F and distances d of one object. Its answers are sampled on a grid of F and of the
contact-aligned coordinate s, and separated,

    u(F, d) = u_0(F) + p sum_i m_i G_i1(F_1) G_i2(F_2) ... H_i(s),   s = p / (D(F) - d_min + soft),   p = D(F) - d,

with u the tip's displacement, the contact force, and what else the source has, u_0 the free answer, D the touch
distance and p the path past it (Chenevier et al., PLoS ONE 13(2): e0192052, 2018; `rom.separated.parts`).
The derivatives of the samples make the one-dimensional functions cubic Hermite functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, Protocol

import numpy as np
from scipy.ndimage import distance_transform_edt

from rom.brief import brief
from rom.native.answer import FORCE, PAD, TOUCH
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.model import SeparatedModel
from rom.separated.parts import SOFT, ContactCoordinates, Errors, Field
from rom.separated.separate import Samples, further_modes, separated_samples
from rom.separated.separated_form import Separated
from rom.terminal import Progress, quiet

NODES = 32  # of every axis
FINER = 0.03  # share of the tolerance that the free answer is separated to: contact begins where it says
TOLERANCE, TERMS = 1e-5, 200  # of the separation, by default [-]
FIRST = 1e-4  # node of s next to touch, where contact is as good as its limit [-]
STEEPEST = 3.0  # of slopes at nodes over differences between them: beyond, a cubic function is no longer monotone [-]
DETERMINED = 3.0  # values in contact for every number of the separated form, at least [-]
CELLS = 20_000  # of the lookup of what is known, at most
ROUNDING = 1e-9  # share of the contact path [-]
LEAST_RANGE = 1e-3  # of d, over the finger's length [-]


@brief
class Sampled(NamedTuple):
    """A source's answers at n points.

    Attributes:
        out: tip [m], contact force [N], touch distance [m], pad pressure [Pa] if the source has it, and the amounts of
            k modes of the displacement [m], shape (n, 5 + pad + k).
        jacobian: by the parameters, shape (n, 5 + pad + k, p).
        supports: whether the answer is good enough to support a table, shape (n,).
    """

    out: np.ndarray
    jacobian: np.ndarray
    supports: np.ndarray


class Source(Protocol):
    """What a table is sampled from: tensions [N] and d [m], also nearer and farther than its parameters' range of d."""

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lower and upper of tensions and d."""

    @property
    def scene(self) -> dict[str, Any]:
        """The finger's scene, as plain data."""

    @property
    def lead(self) -> int:
        """Which tension pushes most towards the object."""

    @property
    def has_pad(self) -> bool:
        """Whether it has the pad's pressure."""

    @property
    def modes(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Nodes at rest, shape (nodes, 3) [m], and modes of their displacement, shape (3 nodes, k), if it has any."""

    def sampled(self, points: np.ndarray) -> Sampled:
        """Answers at points, shape (n, p); d = infinity is no object."""


@brief
class Grid(NamedTuple):
    """Nodes in contact: tensions, then s.

    Attributes:
        axes: of every tension [N], and of s [-].
        coordinates: the contact-aligned ones.
        free: answers without the object at the nodes of the tensions.
    """

    axes: Sequence[np.ndarray]
    coordinates: ContactCoordinates
    free: Sampled


def tabulated(
    source: Source,
    nodes: int = NODES,
    options: EnrichmentOptions | None = None,
    progress: Progress = quiet,
) -> SeparatedModel:
    """The table of a source within its parameters' limits, whose errors are still to be measured.

    Args:
        source: what is sampled.
        nodes: of every axis, 4 at least; nodes^(tensions + 1) points in contact are sampled.
        options: of the separation.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        ValueError: fewer than 4 nodes, or an object that is not in the way of the finger.
    """
    if nodes < 4:
        raise ValueError(f"nodes must be at least 4, got {nodes}")
    options = options or EnrichmentOptions(tolerance=TOLERANCE, terms=TERMS)
    progress("sampling", 0, 2)
    grid = _grid(source, nodes)
    progress("sampling", 1, 2)
    free, contact = _free(grid), _contact(source, grid)
    # Contact begins at the free form's touch distance.
    finer = replace(options, tolerance=FINER * options.tolerance)
    fewer = replace(options, terms=determined(options.terms, contact.values[:, : FORCE + 1].size, grid.axes))
    progress("separating the samples", 0, 2)
    alone = separated_samples(free.columns([0, 1, 2, TOUCH]), finer)
    progress("separating the samples", 1, 2)
    pressed = separated_samples(contact.columns([*range(FORCE + 1), *range(PAD, PAD + source.has_pad)]), fewer)
    moved = None if source.modes is None else _field(source, free, contact, alone, pressed)
    p = len(source.parameters)
    cells = int(CELLS ** (1 / p) + 1e-9) ** p
    return SeparatedModel(
        parameters=source.parameters,
        free=alone,
        contact=pressed,
        coordinates=grid.coordinates,
        answered=np.ones(cells, bool),
        errors=Errors(
            tip=0.0, displacement=0.0, touch_distance=0.0, contact=np.zeros((cells, 3 + source.has_pad)), margin=1.0
        ),
        displacements=moved,
        lead=source.lead,
        scene=source.scene,
        accuracy={},
        provenance={"states": len(contact.values), "nodes": nodes},
    )


def _field(source: Source, free: Samples, contact: Samples, alone: Separated, pressed: Separated) -> Field:
    """The displacement of all nodes by the products of the two forms."""
    assert source.modes is not None
    nodes, basis = source.modes
    amounts = slice(PAD + source.has_pad, None)
    pairs = ((alone, free), (pressed, contact))
    own = [further_modes(form.factors, samples.values[:, amounts], samples.known) for form, samples in pairs]
    return Field(nodes=nodes, basis=basis.astype(np.float32), free=own[0], contact=own[1])


def determined(terms: int, values: int, axes: Sequence[np.ndarray]) -> int:
    """As many of some terms as values on a grid determine DETERMINED times: more would be free between the nodes."""
    return max(min(terms, int(values / (DETERMINED * (4 + sum(map(len, axes)))))), 1)


def _points(axes: Sequence[np.ndarray]) -> np.ndarray:
    """All nodes of axes, the last one fastest, shape (n, axes)."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def _grid(source: Source, nodes: int) -> Grid:
    """The nodes, and the free answers there."""
    lower, upper = np.array([[one["lower"], one["upper"]] for one in source.parameters], float).T
    tensions = [np.linspace(low, high, nodes) for low, high in zip(lower[:-1], upper[:-1], strict=True)]
    length = sum(source.scene["geometry"]["segments"])
    if not upper[-1] - lower[-1] >= LEAST_RANGE * length:
        raise ValueError(
            f"d must have a range of at least {LEAST_RANGE * length:g} m, got {lower[-1]:g} to {upper[-1]:g} m"
        )
    points = _points(tensions)
    free = source.sampled(np.column_stack([points, np.full(len(points), np.inf)]))
    touch = free.out[:, 4]
    if not np.isfinite(touch).all():
        passed = points[~np.isfinite(touch)][0]
        raise ValueError(
            f"the object must be in the way of the finger at all tensions, but the finger passes it at "
            f"{passed.tolist()} N: narrow the tensions of the scene, or ask the finger itself"
        )
    if touch.max() <= lower[-1]:
        raise ValueError(f"d must begin below {touch.max():.4g} m, where the finger touches, got {lower[-1]:g} m")
    nearest = float(lower[-1])
    reach = float(touch.max()) - nearest
    soft = max(SOFT * reach, 2 * max(nearest - float(touch.min()), 0.0))
    deepest = reach / (reach + soft)
    return Grid([*tensions, np.linspace(FIRST, deepest, nodes)], ContactCoordinates(nearest, soft), free)


def _free(grid: Grid) -> Samples:
    """All columns without contact."""
    out, jacobian = grid.free.out, grid.free.jacobian
    return Samples(grid.axes[:-1], out, jacobian[..., :-1], np.ones(len(out), bool), _sizes(out))


def _contact(source: Source, grid: Grid) -> Samples:
    """What contact adds to all columns per length of its path, by tensions and s.

    Values v = (u - u_0) / p. Along an axis of the tensions d follows D: dd = (1 - s) dD and dp = s dD; along s the path
    grows by w = D - d_min + soft.
    """
    s, free, slopes = grid.axes[-1], grid.free.out, grid.free.jacobian
    n, m = len(free), len(s)
    touch, rising = free[:, TOUCH], slopes[:, TOUCH, :-1]
    whole = touch - grid.coordinates.nearest + grid.coordinates.soft
    path = s * whole[:, None]
    points = np.column_stack([np.repeat(_points(grid.axes[:-1]), m, axis=0), (touch[:, None] - path).ravel()])
    # Beyond the nearest object nothing is asked: there the rubber presses, too, and would take most of the products.
    within = points[:, -1] > grid.coordinates.nearest - ROUNDING * np.repeat(whole, m)
    sampled = source.sampled(points[within])
    out: np.ndarray = np.full((n * m, free.shape[1]), np.nan)
    jacobian: np.ndarray = np.zeros((n * m, *slopes.shape[1:]))
    supports = np.zeros(n * m, bool)
    out[within], jacobian[within], supports[within] = sampled
    supports &= np.isfinite(out).all(axis=1)
    out, jacobian = out.reshape(n, m, -1), jacobian.reshape(n, m, *slopes.shape[1:])
    values = (out - free[:, None]) / path[..., None]
    along = s[None, :, None, None] * rising[:, None, None]
    by_tension = jacobian[..., :-1] + jacobian[..., -1:] * (rising[:, None, None] - along)
    gradient = np.empty_like(jacobian)
    gradient[..., :-1] = (by_tension - slopes[:, None, :, :-1] - values[..., None] * along) / path[..., None, None]
    gradient[..., -1] = -(jacobian[..., -1] + values) * (whole[:, None] / path)[..., None]
    shape = tuple(map(len, grid.axes))
    values, gradient = values.reshape(*shape, -1), gradient.reshape(*shape, *gradient.shape[2:])
    return _continued(grid.axes, values, gradient, supports.reshape(shape))


def _sizes(values: np.ndarray) -> np.ndarray:
    """Largest of every column, 1 where that is 0: a finger that bends in a plane has no third displacement."""
    largest = np.abs(values).max(axis=0)
    return np.where(largest > 0, largest, 1.0)


def _continued(axes: Sequence[np.ndarray], values: np.ndarray, gradient: np.ndarray, supports: np.ndarray) -> Samples:
    """Samples on a grid: a node that does not support the table takes the value of the nearest one that does.

    The table is marked there. Without a value, sums of products would be free there, and expensive to find.
    """
    nearest = tuple(distance_transform_edt(~supports, return_distances=False, return_indices=True))
    values = values[nearest]
    gradient = _limited(axes, values, np.where(supports[..., None, None], gradient, 0.0))
    values, gradient = values.reshape(supports.size, -1), gradient.reshape(supports.size, values.shape[-1], -1)
    return Samples(axes, values, gradient, np.ones(len(values), bool), _sizes(values))


def _limited(axes: Sequence[np.ndarray], values: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """Slopes at the nodes, no steeper than STEEPEST times the steeper of both neighbouring differences.

    Where two corners touch at once, D has a kink, and slopes just past touch are those of one side, over a path of
    micrometres: a cubic function would leave all bounds between the nodes.
    """
    limited = np.empty_like(gradient)
    for a, axis in enumerate(axes):
        differences = np.abs(np.diff(values, axis=a)) / np.diff(axis)[0]
        ends = [np.take(differences, [k], axis=a) for k in (0, -1)]
        steepest = STEEPEST * np.maximum(
            np.concatenate([ends[0], differences], axis=a), np.concatenate([differences, ends[1]], axis=a)
        )
        limited[..., a] = np.clip(gradient[..., a], -steepest, steepest)
    return limited
