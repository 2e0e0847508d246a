"""Contact with friction: the forces of points that press on an obstacle, their tangent, their history.

The points are those of contact without friction. Each has its own normal force, and one stiffness along the surface
and across it. During a history they replace the compiled forms. Springs at the closest points of plates remain, and get
friction here. Such a point moves along the plate as a round obstacle rolls; its displacement is that of the material.

The symmetric part of the tangent is assembled with the other springs. A bound changes with the normal force, and a
force turns with the obstacle's normal: both parts are not symmetric, and have a low rank (`LowRank`).
"""

from typing import NamedTuple

import numpy as np
from dolfinx import fem, la

from fingerfem.discretisation.contact.closest_points import NONE, ClosestPoints, Springs
from fingerfem.discretisation.contact.contact_points import FixedPoints, PressingPoints
from fingerfem.discretisation.loads.plate_loads import LowRank
from fingerfem.mechanics import friction
from fingerfem.mechanics.obstacles import Body

NEGLIGIBLE = 1e-12  # singular values over the largest of their facet [-]


class FrictionLaw(NamedTuple):
    """Friction on an obstacle: the coefficient [-], and r of `mechanics.friction` [N/m]."""

    body: Body
    coefficient: float
    yielding: float


class Drag(NamedTuple):
    """Points that press at one displacement, and their friction.

    Attributes:
        points: m of them.
        is_fixed: whether a point is one of FixedPoints, whose normal forces are assembled here, shape (m,).
        places: of the points, shape (m, 3) [m].
        normals: of the obstacle, shape (m, 3) [-].
        curvatures: gradients of the normals, shape (m, 3, 3) [1/m].
        normal_forces: shape (m,) [N].
        missed: sum of the normal forces at points that the active set has as open [N].
        bounds: of the tangential forces, shape (m,) [N].
        stretches: of the tangential springs, shape (m, 3) [m].
        tangential: their forces by the linearised law.
    """

    points: PressingPoints
    is_fixed: np.ndarray
    places: np.ndarray
    normals: np.ndarray
    curvatures: np.ndarray
    normal_forces: np.ndarray
    missed: float
    bounds: np.ndarray
    stretches: np.ndarray
    tangential: friction.Tangential

    def lawful(self) -> np.ndarray:
        """The forces that obey Coulomb's law at these stretches, shape (m, 3) [N]."""
        return friction.returned(self.stretches, self.points.stiffness, self.bounds)

    def pushing(self) -> tuple[np.ndarray, np.ndarray]:
        """Normal forces of the fixed points, and minus their derivatives by the places, shapes (m, 3), (m, 3, 3)."""
        force = np.where(self.is_fixed, self.normal_forces, 0.0)[:, None] * self.normals
        stiffness = np.where(self.is_fixed, self.points.stiffness, 0.0)[:, None, None]
        turning = np.where(self.is_fixed, self.normal_forces, 0.0)[:, None, None] * self.curvatures
        return force, stiffness * self.normals[:, :, None] * self.normals[:, None] - turning

    def kept(self) -> np.ndarray:
        """Stretches of the springs under the lawful forces, shape (m, 3) [m]."""
        return np.asarray(self.lawful() / self.points.stiffness[:, None])


class History(NamedTuple):
    """An equilibrium, from which the next increment begins.

    Attributes:
        displacement: of the nodes, shape (3 nodes,) [m].
        distance: of the obstacle [m].
        drag: there; None before the first contact.
    """

    displacement: np.ndarray
    distance: float
    drag: Drag | None


class FrictionPoints:
    """The points of this rank that press, since the last equilibrium.

    Args:
        displacement: of the finger.
        distance: of the obstacle [m].
        fixed: points whose normal forces are assembled here.
        closest: points of plates, whose normal forces are assembled with their springs; or none.
        law: of friction.
    """

    def __init__(
        self,
        displacement: fem.Function,
        distance: fem.Constant,
        fixed: FixedPoints,
        closest: ClosestPoints | None,
        law: FrictionLaw,
    ):
        self._u, self._distance, self._fixed, self._closest, self._law = displacement, distance, fixed, closest, law
        self._rest = displacement.function_space.tabulate_dof_coordinates()
        self.start()

    def start(self, history: History | None = None) -> None:
        """Start from a history, or without any from the present displacement."""
        self.history = history or History(*self._now(), None)
        self._carried = np.zeros(3)
        self._drag, self._of = self.history.drag, self.history[:2]  # the last one, its displacement and distance

    def begin(self, carried: np.ndarray) -> None:
        """Begin an increment: the obstacle moves by `carried`, shape (3,) [m]. The last forces are the first trial."""
        self._carried, self._drag = carried, None

    def settle(self) -> float:
        """End an increment; the work of friction in it [J]."""
        drag = self.drag()
        self.history = History(*self._of, drag)
        return float(np.sum(drag.lawful() * (drag.stretches - drag.kept())))

    def unlawful(self) -> float:
        """Sum of the deviations of forces from the laws [N]. The forces of the linearised laws are the next trial."""
        drag = self.drag()
        wrong = np.abs(drag.tangential.forces - drag.lawful()).sum() + np.maximum(-drag.normal_forces, 0.0).sum()
        self._of = np.zeros(0), 0.0
        return float(wrong) + drag.missed

    def drag(self) -> Drag:
        """The present one. Its trial forces are those of the last one's linearised law at the present displacement."""
        now = self._now()
        if self._drag is None or self._of[1] != now[1] or not np.array_equal(self._of[0], now[0]):
            self._drag, self._of = self._next(*now), now
        return self._drag

    def _now(self) -> tuple[np.ndarray, float]:
        return self._u.x.array.copy(), float(self._distance.value)

    def _next(self, displacement: np.ndarray, distance: float) -> Drag:
        last = self._drag or self.history.drag
        points, is_fixed, missed = self._pressing(displacement, distance, last)
        m = len(points.slots)
        places, far = self._places(displacement, points), np.full(m, distance)
        normals, curvatures = (at(places, far) for at in (self._law.body.normal_at, self._law.body.curvature_at))
        across = friction.across(normals)
        moved = (displacement - self.history.displacement).reshape(-1, 3)[points.nodes]
        stretched = np.einsum("mn,mni->mi", points.weights, moved) - self._carried
        if self.history.drag is not None:
            stretched += _of_slots(points.slots, self.history.drag, self.history.drag.kept())
        stretches = np.einsum("mij,mj->mi", across, stretched)
        normal_forces = -points.stiffness * points.gaps
        bounds = self._law.coefficient * np.maximum(normal_forces, 0.0)
        tried = np.zeros((m, 3)) if last is None else self._tried(points.slots, stretches, bounds, last)
        stiffness = points.stiffness, np.minimum(points.stiffness, self._law.yielding)
        tangential = friction.law(stretches, normals, stiffness, bounds, np.einsum("mij,mj->mi", across, tried))
        tangential = tangential._replace(by_bounds=np.where((bounds > 0)[:, None], tangential.by_bounds, 0.0))
        return Drag(points, is_fixed, places, normals, curvatures, normal_forces, missed, bounds, stretches, tangential)

    def _tried(self, slots: np.ndarray, stretches: np.ndarray, bounds: np.ndarray, last: Drag) -> np.ndarray:
        """Forces of the last linearised law, or those of the last equilibrium, shape (m, 3) [N]."""
        if self._drag is None:
            return _of_slots(slots, last, last.lawful())
        own, then = np.intersect1d(slots, last.points.slots, assume_unique=True, return_indices=True)[1:]
        tried = np.zeros((len(slots), 3))
        tangential, change = last.tangential, stretches[own] - last.stretches[then]
        tried[own] = tangential.forces[then] + np.einsum("mij,mj->mi", tangential.stiffness[then], change)
        tried[own] += (bounds[own] - last.bounds[then])[:, None] * tangential.by_bounds[then]
        return tried

    def _pressing(
        self, displacement: np.ndarray, distance: float, last: Drag | None
    ) -> tuple[PressingPoints, np.ndarray, float]:
        """Points that press, whether they are fixed ones, and the missed force, see Drag.

        As `mechanics.friction` has it, f - r (g + f/k) > 0 with the linearised normal force f, not with -k g.
        """
        slots = np.zeros(0, int) if last is None else last.points.slots[last.is_fixed]
        points = self._fixed.pressing(displacement, distance, slots)
        tried = np.zeros(len(points.slots))
        if last is not None:
            own, then = np.intersect1d(points.slots, last.points.slots, assume_unique=True, return_indices=True)[1:]
            tried[own] = last.normal_forces[then]
            if self._drag is not None:
                change = self._places(displacement, points)[own] - last.places[then]
                tried[own] -= points.stiffness[own] * np.sum(last.normals[then] * change, axis=1)
        r = np.minimum(points.stiffness, self._law.yielding)
        closed = tried > r * (points.gaps + tried / points.stiffness)
        missed = float((points.stiffness * np.maximum(-points.gaps, 0.0))[~closed].sum())
        parts = [PressingPoints(*(part[closed] for part in points))]
        if self._closest is not None:
            others = self._closest.pressing(displacement, distance)
            parts.append(others._replace(slots=others.slots + self._fixed.count))
        is_fixed = np.arange(sum(len(part.slots) for part in parts)) < len(parts[0].slots)
        return PressingPoints(*map(np.concatenate, zip(*parts, strict=True))), is_fixed, missed

    def springs(self) -> Springs:
        """Forces and symmetric stiffness, by facets."""
        drag = self.drag()
        points = drag.points
        if not len(points.slots):
            return NONE
        normal_force, normal_stiffness = drag.pushing()
        nodal = points.weights[:, :, None] * (drag.tangential.forces - normal_force)[:, None]
        between = _between_nodes(points.weights, drag.tangential.stiffness + normal_stiffness)
        nodes, forces, stiffness = _by_facet(points.nodes, nodal, between)
        return Springs(nodes=nodes, forces=forces, stiffness=stiffness, gaps=np.zeros(len(nodes)), energy=0.0, work=0.0)

    def load_gradient(self, carried: np.ndarray) -> np.ndarray:
        """Change of this rank's nodal forces with a motion of the obstacle, shapes (nodes, 3) [N], (3,) [m]."""
        drag = self.drag()
        points, tangential = drag.points, drag.tangential
        change = -np.einsum("mij,j->mi", tangential.stiffness + drag.pushing()[1], carried)
        grown = self._law.coefficient * points.stiffness * (drag.normals @ carried)
        change += grown[:, None] * tangential.by_bounds
        nodal = np.zeros_like(self._rest)
        np.add.at(nodal, points.nodes, points.weights[:, :, None] * change[:, None])
        return nodal

    def unsymmetric(self) -> LowRank:
        """The part that is subtracted from the tangent, without supports (collective)."""
        space, drag = self._u.function_space, self.drag()
        points, tangential, normals = drag.points, drag.tangential, drag.normals
        turning = np.einsum("mij,mj->mi", drag.curvatures, tangential.forces)
        stiffer = (self._law.coefficient * points.stiffness)[:, None] * tangential.by_bounds
        blocks = stiffer[:, :, None] * normals[:, None] + normals[:, :, None] * turning[:, None]
        nodes, whole = _by_facet(points.nodes, _between_nodes(points.weights, blocks))
        left, sizes, right = np.linalg.svd(whole)
        of, column = np.nonzero(sizes > NEGLIGIBLE * sizes.max(axis=1, initial=0.0, keepdims=True))
        left, right = left[of, :, column] * sizes[of, column, None], right[of, column]
        return LowRank(*(_summed(space, nodes[of], part) for part in (left, right)))

    def _places(self, displacement: np.ndarray, points: PressingPoints) -> np.ndarray:
        return np.einsum("mn,mni->mi", points.weights, (self._rest + displacement.reshape(-1, 3))[points.nodes])


def _of_slots(slots: np.ndarray, last: Drag, values: np.ndarray) -> np.ndarray:
    """Values of the last points, shape (last, 3), 0 of others, shape (slots, 3)."""
    chosen = np.zeros((len(slots), 3))
    own, then = np.intersect1d(slots, last.points.slots, assume_unique=True, return_indices=True)[1:]
    chosen[own] = values[then]
    return chosen


def _by_facet(nodes: np.ndarray, *values: np.ndarray) -> list[np.ndarray]:
    """Nodes of the different facets, shape (facets, n), and sums over each one's points of values, shapes (m, ...)."""
    facets, facet = np.unique(nodes, axis=0, return_inverse=True)
    sums = [np.zeros((len(facets), *part.shape[1:])) for part in values]
    for own, part in zip(sums, values, strict=True):
        np.add.at(own, facet.ravel(), part)  # NumPy 2.0 has a column
    return [facets, *sums]


def _between_nodes(weights: np.ndarray, blocks: np.ndarray) -> np.ndarray:
    """Blocks of the n nodes around points, shape (m, 3 n, 3 n), from the points' blocks, shape (m, 3, 3)."""
    m, n = weights.shape
    return np.asarray(np.einsum("ma,mij,mb->maibj", weights, blocks, weights).reshape(m, 3 * n, 3 * n))


def _summed(space: fem.FunctionSpace, nodes: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Vectors of all ranks' facets as their owned values, shape (facets, values) (collective)."""
    comm, owned = space.mesh.comm, 3 * space.dofmap.index_map.size_local
    counts = comm.allgather(len(nodes))
    first = sum(counts[: comm.rank])
    vector, rows = fem.Function(space).x, np.zeros((sum(counts), owned))
    for k, row in enumerate(rows):
        vector.array[:] = 0.0
        if 0 <= k - first < len(nodes):
            vector.array.reshape(-1, 3)[nodes[k - first]] = values[k - first].reshape(-1, 3)
        vector.scatter_reverse(la.InsertMode.add)
        row[:] = vector.array[:owned]
    return rows
