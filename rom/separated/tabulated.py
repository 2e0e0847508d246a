"""Samples on a tensor grid -> a separated model: the paper's equations 2 and 3 in contact-aligned coordinates.

The free finger touches an object at the distance d = D(F). Across that surface everything has a kink that no product
of one-dimensional functions follows. In contact, d is therefore replaced by its share s of the path past touch,

    u(F, d) = u_0(F) + p sum_i m_i G_i1(F_1) G_i2(F_2) ... H_i(s),   p = D(F) - d,   s = p / (D(F) - d_min),

with u the tip's displacement, the contact force, and what else the source has, and u_0 the free answer (Chenevier et
al., PLoS ONE 13(2): e0192052, 2018).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rom.answer import FORCE, PAD, TOUCH
from rom.brief import brief
from rom.console.terminal import Progress, quiet
from rom.parameter import Parameter
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.form import Separated
from rom.separated.model import Errors, Field, SeparatedModel

FINER = 0.03  # share of the tolerance that the free answer is separated to: contact begins where it says
STEEPEST = 3.0  # of slopes at nodes over differences between them: beyond, a cubic function is no longer monotone [-]
LEAST = 1e-3  # of d: its range over the finger's length; and of that range, the shortest path that is sampled [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Source:
    """What is sampled: a finger at tensions F [N] and distances d [m] of one object.

    Attributes:
        parameters: tensions, then d.
        scene: the finger's, as plain data.
        lead: index of the tension that pushes most towards the object.
        axes: nodes of every tension [N], and of s [-], some of even ones.
        sampled: of points, shape (n, p), d = infinity without the object, nan where nothing is asked: values, shape
            (n, m), and derivatives of the leading ones by the parameters, shape (n, 5 + has_pad, p); nan without an
            answer. Values are tip [m], contact force [N], touch distance [m], pad pressure [Pa] if it has that, then
            displacements of `nodes` [m].
        determined: values for every number of the separated form, at least [-]: more terms were free between nodes.
        has_pad: whether it has the pad's pressure.
        nodes: at rest, shape (nodes, 3) [m], if it has their displacement.
    """

    parameters: list[Parameter]
    scene: dict[str, Any]
    lead: int
    axes: Sequence[np.ndarray]
    sampled: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    determined: float
    has_pad: bool = False
    nodes: np.ndarray | None = None


def tabulated(source: Source, options: EnrichmentOptions, progress: Progress = quiet) -> SeparatedModel:
    """The separated model of a source, whose errors are still to be measured.

    Raises:
        ValueError: an object that is not in the way of the finger.
    """
    *tensions, s = source.axes
    grid = np.stack(np.meshgrid(*tensions, indexing="ij"), axis=-1)
    points, shape = grid.reshape(-1, len(tensions)), grid.shape[:-1]
    progress("sampling", 0, 2)
    free = source.sampled(np.column_stack([points, np.full(len(points), np.inf)]))
    _refuse(source, points, free[0][:, TOUCH])
    progress("sampling", 1, 2)
    values, gradient = _contact(source, points, *free)
    progress("separating the samples", 0, 2)
    leading, further = [*range(FORCE), TOUCH], [*range(PAD + source.has_pad, values.shape[-1])]
    finer = replace(options, tolerance=FINER * options.tolerance)  # contact begins at the free form's touch distance
    columns = free[0][:, leading + further].reshape(*shape, -1)
    alone = Separated.of(tensions, columns, free[1][:, leading, :-1].reshape(*shape, FORCE + 1, -1), finer)
    progress("separating the samples", 1, 2)
    leading = [*range(FORCE + 1), *range(PAD, PAD + source.has_pad)]
    numbers = source.determined * (FORCE + 1 + sum(map(len, source.axes)))
    most = int(np.isfinite(values[..., 0]).sum() * (FORCE + 1) / numbers)
    columns, slopes = (part.reshape(*shape, len(s), *part.shape[2:]) for part in (values, gradient[:, :, leading]))
    slopes = _limited(source.axes, columns[..., leading], slopes)
    fewer = replace(options, terms=max(min(options.terms, most), 1))
    pressed = Separated.of(source.axes, columns[..., leading + further], slopes, fewer)
    m = len(leading)
    modes = alone.modes[FORCE + 1 :], pressed.modes[m:]
    return SeparatedModel(
        parameters=source.parameters,
        free=replace(alone, modes=alone.modes[: FORCE + 1]),
        contact=replace(pressed, modes=pressed.modes[:m]),
        answered=np.ones(1, bool),
        errors=Errors(tip=0.0, displacement=0.0, touch_distance=0.0, contact=np.zeros((1, m - 1)), margin=1.0),
        displacements=None if source.nodes is None else Field(source.nodes, *modes),
        lead=source.lead,
        scene=source.scene,
        accuracy={},
        provenance={"states": int(np.isfinite(values[..., 0]).sum()), "nodes": [len(axis) for axis in source.axes]},
    )


def _refuse(source: Source, points: np.ndarray, touch: np.ndarray) -> None:
    """Raise ValueError for distances or an object that no model can be of."""
    length, d = sum(source.scene["geometry"]["segments"]), source.parameters[-1]
    lower, upper = d.lower, d.upper
    if not upper - lower >= LEAST * length:
        raise ValueError(f"d must have a range of at least {LEAST * length:g} m, got {lower:g} to {upper:g} m")
    if np.isinf(touch).any():
        raise ValueError(
            f"the object must be in the way of the finger at all tensions, but the finger passes it at "
            f"{points[np.isinf(touch)][0].tolist()} N: narrow the tensions of the scene, or ask the finger itself"
        )
    if np.nanmax(touch) <= lower:
        raise ValueError(f"d must begin below {np.nanmax(touch):.4g} m, where the finger touches, got {lower:g} m")


def _contact(
    source: Source, points: np.ndarray, free: np.ndarray, by_free: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What contact adds per length of its path, v = (u - u_0) / p, shape (n, n_s, m), and its gradient by F and s.

    Along an axis of the tensions d follows D: dd = (1 - s) dD and dp = s dD; along s the path grows by D - d_min.
    """
    s, d = source.axes[-1], source.parameters[-1]
    touch, rising = free[:, TOUCH], by_free[:, None, TOUCH, None, :-1]
    whole = touch - d.lower
    whole[whole < LEAST * (d.upper - d.lower)] = np.nan  # the finger does not reach the nearest object
    path = whole[:, None] * s
    at = np.column_stack([np.repeat(points, len(s), axis=0), (touch[:, None] - path).ravel()])
    out, jacobian = (part.reshape(*path.shape, *part.shape[1:]) for part in source.sampled(at))
    values = (out - free[:, None]) / path[..., None]
    own, along = values[:, :, : jacobian.shape[2], None], s[:, None, None] * rising
    by_tensions = jacobian[..., :-1] + jacobian[..., -1:] * (rising - along) - by_free[:, None, :, :-1] - own * along
    by_share = -(jacobian[..., -1:] + own) * whole[:, None, None, None]
    return values, np.concatenate([by_tensions, by_share], axis=-1) / path[..., None, None]


def _limited(axes: Sequence[np.ndarray], values: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """Slopes at the nodes, no steeper than STEEPEST times the steeper of both neighbouring differences.

    Where two corners touch at once, D has a kink, and slopes just past touch are those of one side, over a path of
    micrometres: a cubic function would leave all bounds between the nodes.
    """
    limited = np.empty_like(gradient)
    for a, axis in enumerate(axes):
        rise = np.abs(np.diff(np.moveaxis(values, a, -1))) / np.diff(axis)
        ends = [(0, 0)] * (values.ndim - 1)
        before, after = (np.pad(rise, [*ends, side], constant_values=np.nan) for side in ((1, 0), (0, 1)))
        steepest = STEEPEST * np.nan_to_num(np.moveaxis(np.fmax(before, after), -1, a), nan=np.inf)
        limited[..., a] = np.clip(gradient[..., a], -steepest, steepest)
    return limited
