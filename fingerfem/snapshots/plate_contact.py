"""Where a finger stands on the plane: what each plate carries, at which point, and how plates and rubber lie over it.

A rigid plate touches a plane with a corner, an edge or a face. Which of these are active is the contact's
regime: while it stays, everything depends smoothly on the loads; where it changes, everything has a kink.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fingerfem.discretisation.problem import Problem
from fingerfem.scene.grid_lines import in_plate

CORNER = 1e-6  # share of half a plate: a centre of pressure that close to its end is at the end

EQUAL = 1e-9  # of the side: nodes that differ by less are as high [-]


@dataclass(frozen=True, kw_only=True)
class PlateContact:
    """At one state, with plates and stretches of rubber in the order of the segments.

    Attributes:
        plate_height: of the plates' centres over where the finger's face lies at rest, shape (segments,) [m].
        plate_tilt: how this height changes along the plate's own x, y and z: the plane's normal as the plate sees it,
            shape (segments, 3) [-].
        plate_force: part of the contact force that each carries, shape (segments,) [N].
        centre_of_pressure: where it acts, in half lengths of the plate from its centre, -1 to 1 along its own x, y and
            z, shape (segments, 3) [-]; 0 where it carries nothing.
        rubber_reach: how far the rubber of each segment reaches towards the plane, shape (segments,) [m].
        jacobians: derivatives by the parameters, by name, shapes (*quantity, p).
        regime: by plate whether it carries, and -1, 0, 1 along x, y, z for an end, what lies between, the other end;
            then by segment whether its rubber touches; shape (5 segments,).
    """

    plate_height: np.ndarray
    plate_tilt: np.ndarray
    plate_force: np.ndarray
    centre_of_pressure: np.ndarray
    rubber_reach: np.ndarray
    jacobians: dict[str, np.ndarray]
    regime: np.ndarray


class PlateContacts:
    """Takes them from a discrete problem (collective over its ranks)."""

    def __init__(self, problem: Problem):
        self._problem = problem
        scene = problem.scene
        owned = problem.space.dofmap.index_map.size_local
        points = self._points = problem.space.tabulate_dof_coordinates()[:owned]
        self._heights_at_rest = points[:, 1] - scene.geometry.side / 2
        half, plates = scene.geometry.side / 2, scene.outline.plates
        self._sizes = np.array([scene.geometry.plate / 2, half, half])
        self._nodes, self._places, self._rubber = [], [], []
        surface = np.zeros(owned, bool)
        surface[problem.surface_nodes[problem.surface_nodes < owned]] = True
        begins, near = 0.0, scene.outline.tolerance
        for k, (start, end) in enumerate(plates):
            nodes = np.flatnonzero(in_plate(scene.outline, k, points.T))
            self._nodes.append(nodes)
            self._places.append((points[nodes] - [(start + end) / 2, 0, 0]) / self._sizes)
            between = (points[:, 0] > begins + near) & (points[:, 0] < start - near)
            self._rubber.append(np.flatnonzero(between & surface))
            begins = end

    def at(self, changes: np.ndarray) -> PlateContact:
        """Of the state the problem is in, whose displacement changes with the parameters by `changes`, shape (p, n)."""
        problem, count = self._problem, len(self._nodes)
        owned = len(self._heights_at_rest)
        height_changes = np.array([change[1 : 3 * owned : 3] for change in changes]).reshape(len(changes), owned)
        heights = self._heights_at_rest + problem.displacement[1 : 3 * owned : 3]
        distance = problem.distance
        poses = [self._pose(k, heights) for k in range(count)]
        pose_jacobians = [np.array([self._pose(k, change) for change in height_changes]).T for k in range(count)]
        loads, load_jacobians = self._loads(height_changes, distance)
        carries = loads[:, 0] > 0
        force = np.where(carries, loads[:, 0], 1.0)[:, None]
        centre = np.where(carries[:, None], loads[:, 1:] / force, 0.0)
        centre_jacobian = np.where(
            carries[:, None, None],
            (load_jacobians[:, 1:] - centre[:, :, None] * load_jacobians[:, :1]) / force[:, :, None],
            0.0,
        )
        highest = [self._highest(nodes, heights, height_changes) for nodes in self._rubber]
        reach = np.array([found[0] for found in highest])
        ends = np.where(np.abs(centre) >= 1 - CORNER, np.sign(centre), 0.0)
        touches = reach > (np.inf if distance is None else distance)
        return PlateContact(
            plate_height=np.array([pose[0] for pose in poses]),
            plate_tilt=np.array([pose[1:] for pose in poses]),
            plate_force=loads[:, 0],
            centre_of_pressure=centre,
            rubber_reach=reach,
            jacobians={
                "plate_height": np.array([jacobian[0] for jacobian in pose_jacobians]),
                "plate_tilt": np.array([jacobian[1:] for jacobian in pose_jacobians]),
                "plate_force": load_jacobians[:, 0],
                "centre_of_pressure": centre_jacobian,
                "rubber_reach": np.array([found[1] for found in highest]),
            },
            regime=np.append(np.column_stack([carries, ends]).ravel(), touches).astype(float),
        )

    def _pose(self, k: int, heights: np.ndarray) -> np.ndarray:
        """Height of plate k's centre and its slopes along x, y and z [-], shape (4,): heights fitted by a plane."""
        own = np.column_stack([np.ones(len(self._nodes[k])), self._places[k]])
        sums = self._problem.comm.allreduce(np.column_stack([own.T @ own, own.T @ heights[self._nodes[k]]]))
        if self._problem.scene.is_half:  # the mirror image
            sums[:3, 3] = sums[3, :3] = sums[3, 4] = 0.0
        return np.asarray(np.linalg.solve(sums[:, :4], sums[:, 4])) / [1.0, *self._sizes]

    def _loads(self, height_changes: np.ndarray, distance: float | None) -> tuple[np.ndarray, np.ndarray]:
        """Force [N] and its moments by x, y and z of every plate, and derivatives: (plates, 4), (plates, 4, p)."""
        count, p = len(self._nodes), len(height_changes)
        loads, load_jacobians = np.zeros((count, 4)), np.zeros((count, 4, p))
        if distance is None:
            return loads, load_jacobians
        forces, stiffness = self._nodal
        plane_motion = np.zeros(p)
        plane_motion[-1] = 1.0  # the plane's own motion
        for k, (nodes, places) in enumerate(zip(self._nodes, self._places, strict=True)):
            own = np.column_stack([np.ones(len(nodes)), places])
            loads[k] = forces[nodes] @ own
            # The plates' contact is a penalty: a node's force goes with its own height over the plane alone.
            load_jacobians[k] = own.T @ (stiffness[nodes][:, None] * (height_changes[:, nodes].T - plane_motion))
        loads = self._problem.copies * self._problem.comm.allreduce(loads)
        load_jacobians = self._problem.copies * self._problem.comm.allreduce(load_jacobians)
        if self._problem.scene.is_half:
            loads[:, 3] = load_jacobians[:, 3] = 0.0
        return loads, load_jacobians

    @property
    def _nodal(self) -> tuple[np.ndarray, np.ndarray]:
        """Contact forces at the nodes along y [N], and how they grow with the nodes' own heights [N/m]."""
        forms, owned = self._problem.forms.contact, len(self._heights_at_rest)  # before the plane, without springs
        assert forms is not None
        forces, stiffness = (self._problem.nodal(form)[:owned, 1] for form in (forms.nodal_force, forms.force_gradient))
        return forces, stiffness

    def _highest(self, nodes: np.ndarray, heights: np.ndarray, height_changes: np.ndarray) -> tuple[float, np.ndarray]:
        """Height of the highest of some nodes, and its derivatives; of several as high, of the one farthest out."""
        comm = self._problem.comm
        own = heights[nodes]
        highest = comm.allreduce(float(own.max(initial=-np.inf)), op=MPI.MAX)
        equal = nodes[own > highest - EQUAL * self._problem.scene.geometry.side]
        order = np.lexsort((self._points[equal, 2], self._points[equal, 0]))
        places = [(*self._points[node, [0, 2]], height_changes[:, node]) for node in equal[order[-1:]]]
        _, _, slopes = max((place for part in comm.allgather(places) for place in part), key=lambda place: place[:2])
        return highest, slopes
