"""Samples on a tensor grid -> a separated model: the paper's equations 2 and 3 in contact-aligned coordinates.

The free finger touches an object at the distance d = D(F). Across that surface everything has a kink that no product
of one-dimensional functions follows. In contact, d is therefore replaced by its share s of the path past touch,

    u(F, d) = u_0(F) + p sum_i m_i G_i1(F_1) G_i2(F_2) ... H_i(s),   p = D(F) - d,   s = p / (D(F) - d_min),

with u the tip's displacement, the contact force, and what else was sampled, and u_0 the free answer (Chenevier et
al., PLoS ONE 13(2): e0192052, 2018).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rom.answer import FORCE, PAD, TOUCH
from rom.brief import brief
from rom.console.terminal import Progress, quiet
from rom.parameter import Parameter
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.errors import Errors
from rom.separated.form import Separated
from rom.separated.model import SeparatedModel

FINER = 0.03  # share of the tolerance that the free answer is separated to: contact begins where it says
STEEPEST = 3.0  # of slopes at nodes over differences between them: beyond, a cubic function is no longer monotone [-]
LEAST = 1e-3  # of the range of d: the shortest path that is sampled [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Samples:
    """Answers of a finger at tensions F [N], without and before one object; nan where it has none.

    The m values are tip [m], contact force [N], touch distance [m], pad pressure [Pa] if there is a pad, and
    displacements of `nodes` [m]. The first r = 5 or 6, all but the last kind, have derivatives by the p parameters.

    Attributes:
        parameters: tensions, then d.
        scene: the finger's, as plain data.
        axes: nodes of every tension [N], and of s [-], some of even ones.
        free: values and derivatives without the object, shapes (n_1, ..., m) and (n_1, ..., r, p).
        contact: likewise at the nodes of s, shapes (n_1, ..., n_s, m) and (n_1, ..., n_s, r, p).
        determined: values for every number of the separated form, at least [-]: more terms were free between nodes.
        nodes: at rest, shape (nodes, 3) [m]; None without their displacement.
    """

    parameters: list[Parameter]
    scene: dict[str, Any]
    axes: Sequence[np.ndarray]
    free: tuple[np.ndarray, np.ndarray]
    contact: tuple[np.ndarray, np.ndarray]
    determined: float
    nodes: np.ndarray | None = None


def tabulated(samples: Samples, options: EnrichmentOptions, progress: Progress = quiet) -> SeparatedModel:
    """The separated model of samples, whose errors are still to be measured.

    Raises:
        ValueError: too few samples.
    """
    tensions = samples.axes[:-1]
    (free, by_free), (added, gradient) = samples.free, _added(samples)
    r, m = by_free.shape[-2], free.shape[-1]
    count = int(np.isfinite(added[..., 0]).sum())
    most = int(count * (FORCE + 1) / (samples.determined * (FORCE + 1 + sum(map(len, samples.axes)))))
    finer = replace(options, tolerance=FINER * options.tolerance)  # contact begins at the free form's touch distance
    fewer = replace(options, terms=max(min(options.terms, most), 1))
    progress("separating the samples", 0, 2)
    rows, field = [*range(FORCE), TOUCH], [*range(r, m)]
    alone = Separated.of(tensions, free[..., rows + field], by_free[..., rows, :-1], finer)
    progress("separating the samples", 1, 2)
    rows = [*range(FORCE + 1), *range(PAD, r)]
    slopes = _limited(samples.axes, added[..., rows], gradient[..., rows, :])
    pressed = Separated.of(samples.axes, added[..., rows + field], slopes, fewer)
    unmeasured = np.zeros((*[1] * len(samples.axes), r - 2))  # in one cell
    return SeparatedModel(
        parameters=samples.parameters,
        free=alone,
        contact=pressed,
        errors=Errors(tip=0.0, displacement=0.0, touch_distance=0.0, contact=unmeasured, margin=1.0),
        nodes=samples.nodes,
        scene=samples.scene,
        accuracy={},
        provenance={"states": count, "nodes": [len(axis) for axis in samples.axes]},
    )


def _added(samples: Samples) -> tuple[np.ndarray, np.ndarray]:
    """Change of answers by contact per length of its path, v = (u - u_0) / p, and its gradient by F and s.

    Along an axis of the tensions d follows D: dd = (1 - s) dD and dp = s dD; along s the path grows by D - d_min.
    """
    (free, by_free), (values, jacobian) = samples.free, samples.contact
    s, d = samples.axes[-1], samples.parameters[-1]
    whole = free[..., TOUCH] - d.lower
    whole = np.where(whole < LEAST * (d.upper - d.lower), np.nan, whole)  # the nearest object is not reached
    path = whole[..., None] * s
    added = (values - free[..., None, :]) / path[..., None]
    rising = by_free[..., None, TOUCH, None, :-1]
    own, along = added[..., : jacobian.shape[-2], None], s[:, None, None] * rising
    by_d = jacobian[..., -1:]
    by_tensions = jacobian[..., :-1] + by_d * (rising - along) - by_free[..., None, :, :-1] - own * along
    by_share = -(by_d + own) * whole[..., None, None, None]
    return added, np.concatenate([by_tensions, by_share], axis=-1) / path[..., None, None]


def _limited(axes: Sequence[np.ndarray], values: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """Slopes at the nodes, no steeper than STEEPEST times the steeper of both neighbouring differences.

    If two corners touch at once, D has a kink. Slopes just past touch are then those of one side, over a path of
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
