"""Full-order states on the paper's grid as a source of a table: they are separated on their own nodes first.

A training set on a grid (`sampling.tension_nodes`, `sampling.contact_nodes`) has free states at the nodes of the
tensions, and lines of states in contact from touch to the nearest plane. The lead tension F_l of these begins at its
onset o, where the free finger first reaches that plane. Their own coordinates fill a box,

    eta = (F_l - o) / (F_max - o),   c = p / (D - d_min),   p = D - d,

and v = (u - u_0) / p is separated over it by alternating directions, with the derivatives of the states. States that
failed are missing. At eta = 0 and c = 0 the path p is 0: these nodes are left out, and v goes on from their neighbours.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from rom.file_kinds import uses_of
from rom.native.answer import FORCE, PAD, TOUCH
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.nodal_form import NodalForm
from rom.separated.tabulated import TERMS, TOLERANCE, Sampled
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet

MOST_TENSIONS = 2
DETERMINED = 1.4  # values in contact for every number of the form [-]
FARTHER = 0.2  # share of an axis beyond its nodes within which a form still supports a table [-]


class GridSource:
    """A training set on a grid before the plane y = side/2 + d, for one or two tensions.

    It has the pad's pressure and the displacement of all nodes if the set stores them.

    Args:
        snapshots: the set.
        every: takes every so many-th node of every axis, and its last one.
        options: of the separation on the set's own nodes.
        modes: nodes and modes of the displacement, see `rom.separated.grid_model`; None leaves the displacement out.

    Raises:
        SnapshotError: a set without such a grid, or with fewer than 3 nodes of an axis left.
    """

    def __init__(
        self,
        snapshots: SnapshotSet,
        every: int = 1,
        options: EnrichmentOptions | None = None,
        modes: tuple[np.ndarray, np.ndarray] | None = None,
    ):
        description = snapshots.description
        check_grid(snapshots)
        self.snapshots, self.every, self.modes = snapshots, every, modes
        self.has_pad = "pad_pressure" in description.stored
        self.scene, self.lead, self.parameters = description.scene, description.lead, description.parameters
        self._options = options or EnrichmentOptions(tolerance=TOLERANCE, terms=TERMS)
        self.tension_nodes = [self._thin(np.array(axis)) for axis in description.tension_nodes]
        self.nearest, self.highest = self.parameters[-1]["lower"], self.parameters[self.lead]["upper"]
        self._onset = self._onsets()
        self._free = self._free_form()
        self._contact = self._contact_form()

    def _columns(self, kind: str) -> tuple[np.ndarray, np.ndarray]:
        """Columns of `Sampled` of the free or contact states on the grid, and their derivatives; unthinned."""
        read = self.snapshots.free if kind == "free" else self.snapshots.contact
        names = ["contact_force", "touch_distance", *["pad_pressure"] * self.has_pad]
        values = [read("tip"), *(read(name)[..., None] for name in names)]
        slopes = [read("tip_jacobian"), *(read(f"{name}_jacobian")[..., None, :] for name in names)]
        if self.modes is not None:
            field, by = read("displacement"), read("displacement_jacobian")
            grid, basis = field.shape[:-2], self.modes[1]
            values.append(field.reshape(*grid, -1) @ basis)
            slopes.append(np.moveaxis(by.reshape(*grid, by.shape[-3], -1) @ basis.astype(by.dtype), -1, -2))
        return np.concatenate(values, axis=-1), np.concatenate(slopes, axis=-2)

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
        """All columns without contact."""
        t = len(self.tension_nodes)
        values, gradient = (self._thin(one, *range(t)) for one in self._columns("free"))
        gradient = gradient[..., :t]
        solved = self._thin(self.snapshots.free("converged"), *range(t))
        values[~solved], gradient[~solved] = np.nan, np.nan
        terms = self._most(values[..., : TOUCH + 1], 1.0)
        options = replace(self._options, tolerance=self._options.tolerance / 10, terms=terms)
        return NodalForm.of(self.tension_nodes, values, gradient, options, PAD + self.has_pad)

    def _contact_form(self) -> NodalForm:
        """V = (u - u_0) / p of all columns over (tensions with eta in place of the lead, c)."""
        t, description = len(self.tension_nodes), self.snapshots.description
        axes = [*self.tension_nodes, self._thin(np.array(description.contact_nodes))[1:]]
        axes[self.lead] = self._thin(np.array(description.onset_nodes))[1:]
        u, by = (self._thin(one, *range(t + 1)) for one in self._columns("contact"))
        parameters, converged = (
            self._thin(self.snapshots.contact(name), *range(t + 1)) for name in ("parameters", "converged")
        )
        touch, rising = u[..., TOUCH], by[..., TOUCH, :t]
        # What contact adds begins at the first state of every line, where the plane touches.
        alone, by_alone = (np.take(one, [0], axis=t) for one in (u, by))
        by_alone = by_alone * np.append(np.ones(t), 0.0)
        path = (touch - parameters[..., t])[..., None]
        inner = tuple(slice(1, None) if a in (self.lead, t) else slice(None) for a in range(t + 1))
        path, added, by_added = path[inner], (u - alone)[inner], (by - by_alone)[inner]
        good = converged[inner] & (path[..., 0] > 0)
        path = np.where(good[..., None], path, 1.0)
        v, by_point = added / path, by_added / path[..., None]
        by_point[..., :t] -= (v / path)[..., None] * rising[inner][..., None, :]
        by_point[..., t] += v / path
        points = parameters[inner].reshape(-1, t + 1)
        _, by_own = self._own(points, touch[inner].reshape(-1), rising[inner].reshape(-1, t))
        gradient = by_point @ by_own.reshape(*good.shape, t + 1, t + 1)
        v[~good], gradient[~good] = np.nan, np.nan
        options = replace(self._options, terms=self._most(v[..., : FORCE + 1], DETERMINED))
        return NodalForm.of(axes, v, gradient, options, PAD + self.has_pad)

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

    def sampled(self, points: np.ndarray) -> Sampled:
        """Answers at points, shape (n, p), of the separated states."""
        n, t = len(points), len(self.tension_nodes)
        out, slopes = self._free.value_and_gradient(points[:, :t])
        jacobian = np.concatenate([slopes, np.zeros((*out.shape, 1))], axis=2)
        touch, rising = out[:, TOUCH], jacobian[:, TOUCH, :t]
        path = touch - points[:, t]
        pressed = np.flatnonzero(path > 0)
        at, depth = points[pressed], path[pressed]
        own, by_own = self._own(at, touch[pressed], rising[pressed])
        v, gradient = self._contact.value_and_gradient(own)
        v[:, TOUCH], gradient[:, TOUCH] = 0.0, 0.0
        jacobian[pressed] += depth[:, None, None] * (gradient @ np.linalg.inv(by_own))
        jacobian[pressed, :, :t] += v[..., None] * rising[pressed][:, None]
        jacobian[pressed, :, t] -= v
        out[pressed] += depth[:, None] * v
        supports = np.ones(n, bool)
        supports[pressed] = (own[:, self.lead] > -FARTHER) & (own[:, t] < 1 + FARTHER) & (touch[pressed] > self.nearest)
        return Sampled(out, jacobian, supports)


def check_grid(snapshots: SnapshotSet) -> None:
    """Refuse a set without a grid of one or two tensions before a plane.

    Raises:
        SnapshotError: such a set.
    """
    description = snapshots.description
    if description.random or description.has_load or not description.has_obstacle:
        raise SnapshotError(
            f"{snapshots.path}: must be a training set before a plane, on a grid (sampling.tension_nodes and "
            f"contact_nodes){uses_of(snapshots.path)}"
        )
    if description.tensions > MOST_TENSIONS:
        raise SnapshotError(f"{snapshots.path}: must have {MOST_TENSIONS} tensions at most, got {description.tensions}")
