"""Springs at the closest points between the facets of stiff plates and an obstacle, if one of both is round.

A plate of steel touches a ball at one point, which moves along the plate as the ball rolls. Springs that stand still
would be beside it, with another normal, and Newton's method would go from one to the next. So a facet has a spring at
its nearest point, one at the nearest point of every edge, and one at every corner. Towards the end of a facet, or of an
edge, such a spring fades out over the last HEM, and the edge's or the corner's takes over.

The energy of a spring is k g^2 / 2 while the gap g is negative. As its place (s, t) is where g is least, g's first
derivative by the nodes is that at a fixed place, n N; its second one counts that the place moves,

    g'' = N^T C N - B^T A^-1 B,    A = d2g/d(s,t)2,    B = d2g/d(s,t)du,

with the obstacle's normal n, the normal's gradient C and the facet's shape functions N.

If a facet lies flush on the obstacle any point is nearest, and round-off would choose another in every iteration. So
facets and edges are taken for slightly domed: a point's gap grows by DOME/2 times its squared distance from the middle
over the facet's size, by a millionth of that size at the edge. The nearest point of a flush facet is then its middle.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import basix
import numpy as np
from dolfinx import fem
from mpi4py import MPI

from fingerfem.discretisation.contact.contact_points import PressingPoints, SurfaceFacets, tables
from fingerfem.mechanics.obstacles import NUMPY, Body

HEM = 0.005  # of a facet's edge [-]
ITERATIONS, HALVINGS, SETTLED = 60, 30, 1e-13  # towards the nearest points; of a step; a step that is none [-]
DOME = 1e-5  # curvature that facets and edges are given, times the facet's size [-]
FLATTEST = 1e-3  # of that curvature: what is less curved does not move its nearest point [-]
START = np.array([[s, t] for s in np.linspace(0, 1, 5) for t in np.linspace(0, 1, 5)])
# Free coordinates, (s, t), of a facet's springs, and their start: within, on its edges, at its corners.
FREE = np.array([[1, 1], [1, 0], [1, 0], [0, 1], [0, 1], [0, 0], [0, 0], [0, 0], [0, 0]], bool)
FIXED = np.array([[0, 0], [0, 0], [0, 1], [0, 0], [1, 0], [0, 0], [1, 0], [0, 1], [1, 1]], float)


@dataclass(frozen=True)
class Springs:
    """Forces and stiffness of springs at one displacement, by facets that press.

    Attributes:
        nodes: local indices, shape (m, n).
        forces: gradient of the energy by these nodes' displacements, shape (m, n, 3) [N]; what they press with.
        stiffness: and its derivative, shape (m, 3 n, 3 n) [N/m].
        gaps: shape (m,) [m], positive of one that pulls.
        energy: of this rank's springs [J].
        work: sum of force times |gap| [J].
    """

    nodes: np.ndarray
    forces: np.ndarray
    stiffness: np.ndarray
    gaps: np.ndarray
    energy: float
    work: float


NONE = Springs(np.zeros((0, 0), int), np.zeros((0, 0, 3)), np.zeros((0, 0, 0)), np.zeros(0), 0.0, 0.0)


def together(parts: list[Springs]) -> Springs:
    """The springs of several."""
    some = [part for part in parts if len(part.gaps)]
    if len(some) < 2:
        return some[0] if some else NONE
    n = max(part.nodes.shape[1] for part in some)
    some = [_of_nodes(part, n) for part in some]
    return Springs(
        nodes=np.concatenate([one.nodes for one in some]),
        forces=np.concatenate([one.forces for one in some]),
        stiffness=np.concatenate([one.stiffness for one in some]),
        gaps=np.concatenate([one.gaps for one in some]),
        energy=sum(one.energy for one in some),
        work=sum(one.work for one in some),
    )


def _of_nodes(part: Springs, n: int) -> Springs:
    """The same with n nodes a facet, of which the last do nothing."""
    m, own = part.nodes.shape
    if own == n:
        return part
    stiffness = np.zeros((m, 3 * n, 3 * n))
    stiffness[:, : 3 * own, : 3 * own] = part.stiffness
    more = [(0, 0), (0, n - own)]
    nodes, forces = np.pad(part.nodes, more, "edge"), np.pad(part.forces, [*more, (0, 0)])
    return replace(part, nodes=nodes, forces=forces, stiffness=stiffness)


class ClosestPoints:
    """The springs of some of this rank's facets.

    Args:
        space: of the displacement, hexahedra.
        facets: local indices; those of other ranks' cells are left to these.
        stiffness: of a spring per area of its facet [N/m^3].
        body: the obstacle.
    """

    def __init__(self, space: fem.FunctionSpace, facets: np.ndarray, stiffness: float, body: Body):
        self._body, self._comm, self._facets = body, space.mesh.comm, SurfaceFacets(space, facets)
        self.factor = 1.0  # of the stiffness [-]
        self.count = len(FREE) * len(self._facets.nodes)
        middle = self._facets.element.tabulate(1, np.array([[0.5, 0.5]]))[1:, 0, :, 0]
        along = np.einsum("in,mnj->imj", middle, self._facets.rest)
        self._stiffness = stiffness * np.linalg.norm(np.cross(along[0], along[1]), axis=1)  # [N/m], by facet
        squares = np.sum(along**2, axis=2).T
        self._domes = DOME * squares / np.sqrt(squares.sum(axis=1, keepdims=True))  # by (s, t), shape (facets, 2) [m]

    def springs(self, displacement: np.ndarray, distance: float, held: bool = False) -> Springs:
        """Springs at nodal displacements, shape (3 nodes,), and the obstacle's distance [m].

        If contact is held and nothing presses, the spring that is nearest to the obstacle pulls (collective).
        """
        acting = self._acting(displacement, distance, held)
        of, free, k, g = acting.slots // len(FREE), FREE[acting.slots % len(FREE)], acting.stiffness, acting.gaps
        places = self._facets.places(displacement)[of]
        facets = Facets(self._facets.element, places, self._domed(of, free), self._body, distance)
        gradient, curvature = facets.derivatives(acting.at, free)
        flat = gradient.reshape(len(g), 3 * self._facets.nodes.shape[1])
        stiffness = k[:, None, None] * (flat[:, :, None] * flat[:, None] + g[:, None, None] * curvature)
        return Springs(
            nodes=self._facets.nodes[of],
            forces=(k * g)[:, None, None] * gradient,
            stiffness=stiffness,
            gaps=g,
            energy=float(k @ g**2 / 2),
            work=float(k @ g**2),
        )

    def pressing(self, displacement: np.ndarray, distance: float) -> PressingPoints:
        """The springs that press. Slots are those of a facet: within, its edges, its corners."""
        acting = self._acting(displacement, distance, held=False)
        nodes, weights = self._facets.nodes[acting.slots // len(FREE)], self._facets.shapes(acting.at)
        return PressingPoints(acting.slots, nodes, weights, acting.stiffness, acting.gaps)

    def _domed(self, facets: np.ndarray, free: np.ndarray) -> np.ndarray:
        return np.asarray(np.where(free, self._domes[facets], 0.0))

    def _acting(self, displacement: np.ndarray, distance: float, held: bool) -> _Acting:
        """The springs of `springs`."""
        places = self._facets.places(displacement)
        middle = places.mean(axis=1)
        radius = np.linalg.norm(places - middle[:, None], axis=2).max(axis=1, initial=0.0)
        away = self._body.signed_distance(middle.T, distance, NUMPY)
        farthest = max(0.0, float((away + radius).min(initial=np.inf))) if held else 0.0
        near = np.flatnonzero(away - radius <= farthest)
        slots = (near[:, None] * len(FREE) + np.arange(len(FREE))).ravel()
        of, free = slots // len(FREE), np.tile(FREE, (len(near), 1))
        facets = Facets(self._facets.element, places[of], self._domed(of, free), self._body, distance)
        at = facets.nearest(np.tile(FIXED, (len(near), 1)), free)
        inside = np.where(free, np.minimum(at, 1 - at), np.inf).min(axis=1)
        share = np.clip(inside / HEM, 0.0, 1.0)
        weight = self._stiffness[of] * share**2 * (3 - 2 * share)
        gap = np.where(weight > 0, facets.gaps(at), np.inf)
        acts = gap < 0
        if held:
            least = self._comm.allreduce(float(gap.min(initial=np.inf)), op=MPI.MIN)
            acts |= (gap <= least) & np.isfinite(gap)
        return _Acting(slots[acts], at[acts], self.factor * weight[acts], gap[acts])


class _Acting(NamedTuple):
    """Springs that act: slots, shape (m,); places (s, t), shape (m, 2); stiffness [N/m] and gaps [m], shapes (m,)."""

    slots: np.ndarray
    at: np.ndarray
    stiffness: np.ndarray
    gaps: np.ndarray


class Facets:
    """Deformed facets before an obstacle.

    Args:
        element: of the reference facet.
        places: of their nodes, shape (m, n, 3) [m].
        domes: second derivatives of the gaps by (s, t) that are added, 0 along what is fixed, shape (m, 2) [m].
        body: the obstacle, at `distance` [m].
    """

    def __init__(
        self,
        element: basix.finite_element.FiniteElement,
        places: np.ndarray,
        domes: np.ndarray,
        body: Body,
        distance: float,
    ):
        self._element, self._places, self._domes = element, places, domes
        self._body, self._distance = body, distance

    def gaps(self, at: np.ndarray) -> np.ndarray:
        """Gaps at local positions, shape (m, 2); shape (m,) [m]."""
        values = tables(self._element, 0, at)[0]
        x = np.einsum("mn,mni->mi", values, self._places)
        domed = np.sum(self._domes * (at - 0.5) ** 2, axis=1) / 2
        return np.asarray(self._body.signed_distance(x.T, self._distance, NUMPY) + domed)

    def _bent(self, at: np.ndarray) -> tuple[np.ndarray, ...]:
        """Shape functions and their first and second derivatives; of the gap by (s, t); normals and their gradients."""
        shapes = np.moveaxis(tables(self._element, 2, at), 0, 1)  # (m, derivatives, n)
        x = np.einsum("mdn,mni->mdi", shapes, self._places)
        d = np.full(len(at), self._distance)
        normal, turning = self._body.normal_at(x[:, 0], d), self._body.curvature_at(x[:, 0], d)
        along, second = x[:, 1:3], x[:, [3, 4, 4, 5]].reshape(-1, 2, 2, 3)
        slope = np.einsum("mi,mai->ma", normal, along) + self._domes * (at - 0.5)
        bend = np.einsum("mai,mij,mbj->mab", along, turning, along) + np.einsum("mi,mabi->mab", normal, second)
        bend += self._domes[:, :, None] * np.eye(2)
        return shapes, along, slope, bend, normal, turning

    def nearest(self, start: np.ndarray, free: np.ndarray) -> np.ndarray:
        """Points of least gap, shape (m, 2), by projected Newton steps in the free coordinates, shape (m, 2)."""
        at, value = start.copy(), np.full(len(start), np.inf)
        for begin in START:
            tried = np.where(free, begin, start)
            gap = self.gaps(tried)
            better = gap < value
            at[better], value[better] = tried[better], gap[better]
        for _ in range(ITERATIONS):
            _, _, slope, bend, _, _ = self._bent(at)
            held = ~free | ((at <= 0) & (slope > 0)) | ((at >= 1) & (slope < 0))
            slope[held] = 0.0
            least = self._domes.max(axis=1, initial=0.0)[:, None]  # [m]; 0 where nothing is free
            step = -np.linalg.solve(_held(bend + 1e-6 * least[..., None] * np.eye(2), held), slope[..., None])[..., 0]
            downhill = np.sum(step * slope, axis=1) < 0
            step = np.where(downhill[:, None], step, -slope / np.where(least > 0, least, 1.0))
            share = np.ones(len(at))
            for _ in range(HALVINGS):
                ahead = np.clip(at + share[:, None] * step, 0, 1)
                gap = self.gaps(ahead)
                worse = gap > value + 1e-18
                if not worse.any():
                    break
                share[worse] /= 2
            ahead[worse], gap[worse] = at[worse], value[worse]
            moved = np.abs(ahead - at).max(initial=0.0)
            at, value = ahead, gap
            if moved < SETTLED:
                break
        return at

    def derivatives(self, at: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gradient and Hessian of gaps at nearest points by nodes, shapes (m, n, 3) [-] and (m, 3 n, 3 n) [1/m]."""
        shapes, along, _, bend, normal, turning = self._bent(at)
        gradient = shapes[:, 0, :, None] * normal[:, None]
        m, n = gradient.shape[:2]
        curvature = np.einsum("ma,mij,mb->maibj", shapes[:, 0], turning, shapes[:, 0]).reshape(m, 3 * n, 3 * n)
        turned = np.einsum("mij,mcj->mci", turning, along)
        mixed = shapes[:, 0, None, :, None] * turned[:, :, None] + shapes[:, 1:3, :, None] * normal[:, None, None]
        mixed = (mixed * free[:, :, None, None]).reshape(m, 2, 3 * n)
        values, vectors = np.linalg.eigh(_held(bend, ~free))
        least = FLATTEST * self._domes.max(axis=1, initial=0.0)[:, None]
        moves = np.divide(1.0, values, out=np.zeros_like(values), where=np.abs(values) > least)
        turned = np.swapaxes(vectors, 1, 2) @ mixed
        return gradient, curvature - np.swapaxes(turned, 1, 2) @ (moves[:, :, None] * turned)


def _held(bend: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Second derivatives by (s, t), shape (m, 2, 2), of which some are held."""
    curvatures = np.where(held[:, :, None] | held[:, None], 0.0, bend)
    curvatures[:, [0, 1], [0, 1]] += held
    return curvatures
