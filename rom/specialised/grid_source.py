"""Full-order states on the paper's grid as a source of a table: they are separated on their own nodes first.

A training set on a grid (`sampling.tension_nodes`, `sampling.contact_nodes`) has free states at the nodes of the
tensions, and lines of states in contact from touch to the nearest plane. The lead tension F_l of these begins at its
onset o, where the free finger first reaches that plane. Their own coordinates fill a box,

    eta = (F_l - o) / (F_max - o),   c = p / (D - d_min),   p = D - d,

and v = (u - u_0) / p is separated over it by alternating directions, with the derivatives of the states. States that
failed are missing. At eta = 0 and c = 0 the path p is 0: these nodes are left out, and v goes on from their neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from rom.brief import brief
from rom.file_kinds import uses_of
from rom.held_out import points_of
from rom.separated.alternating_directions import EnrichmentOptions, separate, slopes
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet
from rom.specialised.table import NODES, TERMS, TOLERANCE, Sampled, tabulated
from rom.specialised.table_errors import Truth, compared, with_errors
from rom.summaries import origin as origin_of
from rom.surrogate import Surrogate
from rom.terminal import Progress, quiet

MOST_TENSIONS = 2
CONTACT = (
    *("parameters", "converged", "tip", "tip_jacobian", "contact_force", "contact_force_jacobian"),
    *("touch_distance", "touch_distance_jacobian"),
)
DETERMINED = 1.4  # values in contact for every number of the form [-]
FARTHER = 0.2  # share of an axis beyond its nodes within which a form still supports a table [-]


@brief
@dataclass(frozen=True)
class NodalForm:
    """A separated form sum_k mode_jk prod_a function_ak(x_a) of cubic Hermite functions, on nodes of any spacing."""

    modes: np.ndarray
    functions: Sequence[CubicHermiteSpline]

    @staticmethod
    def of(
        axes: Sequence[np.ndarray], values: np.ndarray, gradient: np.ndarray, options: EnrichmentOptions
    ) -> NodalForm:
        """Separate values, shape (n_1, ..., n_k, m), nan where missing, and their gradient, shape (..., m, k)."""
        size = np.nanmax(np.abs(values).reshape(-1, values.shape[-1]), axis=0)
        size[size == 0] = 1.0
        factors, _ = separate(np.moveaxis(values / size, -1, 0), options)
        tensors = (np.moveaxis(gradient[..., a] / size, -1, 0) for a in range(len(axes)))
        by_axis = [slopes(factors, one, a + 1) for a, one in enumerate(tensors)]
        parts = zip(axes, factors[1:], by_axis, strict=True)
        return NodalForm(size[:, None] * factors[0], [CubicHermiteSpline(*part, axis=0) for part in parts])

    def value_and_gradient(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """At points, shape (n, k): values, shape (n, m), and derivatives, shape (n, m, k)."""
        values = [function(x[:, a]) for a, function in enumerate(self.functions)]
        gradient = []
        for a, function in enumerate(self.functions):
            others = [function(x[:, a], 1) if b == a else one for b, one in enumerate(values)]
            gradient.append(np.prod(others, axis=0) @ self.modes.T)
        return np.prod(values, axis=0) @ self.modes.T, np.stack(gradient, axis=-1)


class GridSource:
    """A training set on a grid before the plane y = side/2 + d, for one or two tensions.

    Args:
        snapshots: the set.
        every: takes every so many-th node of every axis, and its last one.
        options: of the separation on the set's own nodes.

    Raises:
        SnapshotError: a set without such a grid, or with fewer than 3 nodes of an axis left.
    """

    def __init__(self, snapshots: SnapshotSet, every: int = 1, options: EnrichmentOptions | None = None):
        description = snapshots.description
        _check(snapshots)
        self.snapshots, self.every = snapshots, every
        self.scene, self.lead, self.parameters = description.scene, description.lead, description.parameters
        self._options = options or EnrichmentOptions(tolerance=TOLERANCE, terms=TERMS)
        self.tension_nodes = [self._thin(np.array(axis)) for axis in description.tension_nodes]
        self.nearest, self.highest = self.parameters[-1]["lower"], self.parameters[self.lead]["upper"]
        self._onset = self._onsets()
        self._free = self._free_form()
        self._contact = self._contact_form()

    def _thin(self, values: np.ndarray, *axes: int) -> np.ndarray:
        """Every so many-th entry along axes, by default the first one, and the last."""
        for axis in axes or (0,):
            kept = np.unique(np.append(np.arange(0, values.shape[axis], self.every), values.shape[axis] - 1))
            values = np.take(values, kept, axis=axis)
        return values

    def _onsets(self) -> CubicHermiteSpline | float:
        """The lead tension's onset by the other tension [N], or alone."""
        if len(self.tension_nodes) == 1:
            return float(self.snapshots.onset())
        onset, rising = self._thin(self.snapshots.onset()), self._thin(self.snapshots.onset("onset_jacobian"))
        known = np.isfinite(onset)
        if known.sum() < 2:
            raise SnapshotError(f"{self.snapshots.path}: must reach the plane at two nodes of the other tension")
        others = self.tension_nodes[1 - self.lead][known]
        return CubicHermiteSpline(others, onset[known], rising[known, 1 - self.lead])

    def _begins(self, tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Onset and its derivatives by all tensions, at tensions, shape (n, t); shapes (n,) [N] and (n, t) [-]."""
        rising = np.zeros_like(tensions)
        if isinstance(self._onset, float):
            return np.full(len(tensions), self._onset), rising
        other = tensions[:, 1 - self.lead]
        rising[:, 1 - self.lead] = self._onset(other, 1)
        return self._onset(other), rising

    def _free_form(self) -> NodalForm:
        """Tip and touch distance without contact [m]."""
        axes, t = range(len(self.tension_nodes)), len(self.tension_nodes)
        tip, touch = (self._thin(self.snapshots.free(name), *axes) for name in ("tip", "touch_distance"))
        by_tip, by_touch = (
            self._thin(self.snapshots.free(f"{name}_jacobian"), *axes)[..., :t] for name in ("tip", "touch_distance")
        )
        values = np.concatenate([tip, touch[..., None]], axis=-1)
        gradient = np.concatenate([by_tip, by_touch[..., None, :]], axis=-2)
        solved = self._thin(self.snapshots.free("converged"), *axes)
        values[~solved], gradient[~solved] = np.nan, np.nan
        options = replace(self._options, tolerance=self._options.tolerance / 10, terms=self._most(values, 1.0))
        return NodalForm.of(self.tension_nodes, values, gradient, options)

    def _contact_form(self) -> NodalForm:
        """V = (u - u_0) / p of tip and force over (tensions with eta in place of the lead, c)."""
        t, description = len(self.tension_nodes), self.snapshots.description
        part = {name: self._thin(self.snapshots.contact(name), *range(t + 1)) for name in CONTACT}
        axes = [*self.tension_nodes, self._thin(np.array(description.contact_nodes))[1:]]
        axes[self.lead] = self._thin(np.array(description.onset_nodes))[1:]
        u = np.concatenate([part["tip"], part["contact_force"][..., None]], axis=-1)
        by = np.concatenate([part["tip_jacobian"], part["contact_force_jacobian"][..., None, :]], axis=-2)
        touch, rising = part["touch_distance"], part["touch_distance_jacobian"][..., :t]
        # What pushes begins at the first state of every line, where the plane touches.
        alone, by_alone = (np.take(one, [0], axis=t) for one in (u, by))
        by_alone = by_alone * np.append(np.ones(t), 0.0)
        path = (touch - part["parameters"][..., t])[..., None]
        inner = tuple(slice(1, None) if a in (self.lead, t) else slice(None) for a in range(t + 1))
        path, added, by_added = path[inner], (u - alone)[inner], (by - by_alone)[inner]
        good = part["converged"][inner] & (path[..., 0] > 0)
        path = np.where(good[..., None], path, 1.0)
        v, by_point = added / path, by_added / path[..., None]
        by_point[..., :t] -= (v / path)[..., None] * rising[inner][..., None, :]
        by_point[..., t] += v / path
        points = part["parameters"][inner].reshape(-1, t + 1)
        _, by_own = self._own(points, touch[inner].reshape(-1), rising[inner].reshape(-1, t))
        gradient = by_point @ by_own.reshape(*good.shape, t + 1, t + 1)
        v[~good], gradient[~good] = np.nan, np.nan
        return NodalForm.of(axes, v, gradient, replace(self._options, terms=self._most(v, DETERMINED)))

    def _own(self, points: np.ndarray, touch: np.ndarray, rising: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The box's coordinates of points, shape (n, p), and derivatives of the points by them, shape (n, p, p)."""
        t, lead, onset = len(self.tension_nodes), self.lead, self._begins(points[:, :-1])
        own, room = points.copy(), self.highest - onset[0]
        own[:, lead] = (points[:, lead] - onset[0]) / room
        own[:, t] = (touch - points[:, t]) / (touch - self.nearest)
        by_own = np.tile(np.eye(t + 1), (len(points), 1, 1))
        by_own[:, lead, :t] += (1 - own[:, lead, None]) * onset[1]
        by_own[:, lead, lead] = room
        # d = D - c (D - d_min): what D does by the tensions, and these by the coordinates
        by_own[:, t, :t] = (1 - own[:, t, None]) * np.einsum("ni,nij->nj", rising, by_own[:, :t, :t])
        by_own[:, t, t] = self.nearest - touch
        return own, by_own

    def _most(self, values: np.ndarray, determined: float) -> int:
        """Terms that values on a grid determine so many times: with more, they are free between the nodes."""
        return max(min(self._options.terms, int(values.size / (determined * sum(values.shape)))), 1)

    def _without(self, tensions: np.ndarray) -> Sampled:
        """Answers without the plane at tensions, shape (n, t)."""
        n, t = tensions.shape
        values, gradient = self._free.value_and_gradient(tensions)
        out, jacobian = np.zeros((n, 5)), np.zeros((n, 5, t + 1))
        out[:, [0, 1, 2, 4]], jacobian[:, [0, 1, 2, 4], :t] = values, gradient
        return Sampled(out, jacobian, np.ones(n, bool))

    def sampled(self, points: np.ndarray) -> Sampled:
        """Answers at points, shape (n, p), of the separated states."""
        t = len(self.tension_nodes)
        found = self._without(points[:, :t])
        touch, rising = found.out[:, 4], found.jacobian[:, 4, :t]
        path = touch - points[:, t]
        pressed = np.flatnonzero(path > 0)
        at, depth = points[pressed], path[pressed]
        own, by_own = self._own(at, touch[pressed], rising[pressed])
        v, gradient = self._contact.value_and_gradient(own)
        by_point = gradient @ np.linalg.inv(by_own)
        found.out[pressed, :4] += depth[:, None] * v
        found.jacobian[pressed, :4] += depth[:, None, None] * by_point
        found.jacobian[pressed, :4, :t] += v[..., None] * rising[pressed][:, None]
        found.jacobian[pressed, :4, t] -= v
        supports = found.supports.copy()
        supports[pressed] = (own[:, self.lead] > -FARTHER) & (own[:, t] < 1 + FARTHER) & (touch[pressed] > self.nearest)
        return Sampled(found.out, found.jacobian, supports)

    def states(self) -> Truth:
        """All states of the set, with no error of their own: they are the truth that it is a source for."""
        points = np.concatenate([self.snapshots.states_of(kind, "parameters") for kind in ("free", "contact")])
        points[np.isnan(points)] = np.inf
        columns = [
            np.concatenate([self.snapshots.states_of(kind, name) for kind in ("free", "contact")])
            for name in ("tip", "contact_force", "touch_distance")
        ]
        return _truth(points, *columns)


def _truth(points: np.ndarray, tip: np.ndarray, force: np.ndarray, touch: np.ndarray) -> Truth:
    return Truth(points, np.column_stack([tip, force, touch]), np.zeros((len(points), 3)), np.ones(len(points), bool))


def _check(snapshots: SnapshotSet) -> None:
    """Refuse a set without a grid of one or two tensions before a plane."""
    description = snapshots.description
    if description.random or description.scattered or description.refines or not description.has_obstacle:
        raise SnapshotError(
            f"{snapshots.path}: must be a training set before a plane, on a grid (sampling.tension_nodes and "
            f"contact_nodes){uses_of(snapshots.path)}"
        )
    if description.tensions > MOST_TENSIONS:
        raise SnapshotError(f"{snapshots.path}: must have {MOST_TENSIONS} tensions at most, got {description.tensions}")


def separate_grid(
    snapshots: SnapshotSet,
    nodes: int = NODES,
    options: EnrichmentOptions | None = None,
    *,
    held_out: SnapshotSet | None = None,
    progress: Progress = quiet,
) -> Surrogate:
    """The table of full-order states on a grid, as the paper makes it.

    Its estimated errors are those of the table of every second node, at all states. Held-out states, if there are any,
    measure its accuracy.

    Args:
        snapshots: a training set on a grid of one or two tensions.
        nodes: of every axis of the table, 4 at least.
        options: of the separations.
        held_out: states before the same plane.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        SnapshotError: a set without such a grid.
        ValueError: fewer than 4 nodes.
    """
    whole, half = GridSource(snapshots, 1, options), GridSource(snapshots, 2, options)
    table, fewer = (tabulated(one, nodes, options, progress) for one in (whole, half))
    table = replace(table, errors=with_errors(fewer, whole.states()).errors)
    origin = origin_of(snapshots)
    table = replace(table, provenance=table.provenance | origin)
    if held_out is None:
        return table
    columns = [held_out.random(name) for name in ("tip", "contact_force", "touch_distance")]
    return replace(table, accuracy=compared(table, _truth(points_of(held_out), *columns)))
