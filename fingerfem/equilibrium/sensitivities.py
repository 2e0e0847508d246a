"""Derivatives of what a state reports by every tension, and by d or the wrenches on the plates.

du/dp = -K^-1 dR/dp, one back-substitution each on the tangent factorised at the state. dR/dF_k is the gradient of
tendon k's length, dR/dp_k minus that of chamber k's volume and dR/dd minus that of the contact force, so the same
vectors also differentiate those.
"""

from dataclasses import dataclass

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc

from fingerfem.discretisation.loads.plate_loads import PlateLoads
from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.linearisation import Linearisation


@dataclass(frozen=True, kw_only=True)
class Sensitivities:
    """Derivatives at one state by p parameters.

    These are the tensions [1/N] and pressures [1/Pa], then d [1/m] where there is a plane, or every component of the
    wrenches [1/N, 1/(N m)] where there is a load.

    Attributes:
        displacement: of this rank's owned nodes, shape (p, 3 nodes) [m].
        tip: shape (p, 3) [m].
        channel_shortening: shape (p, tendons) [m].
        chamber_volumes: shape (p, chambers) [m^3].
        touch_distance: of a free state as the parameters grow, shape (p,) [m]; None in contact or if it never touches.
        contact_force: shape (p,) [N]; None without a plane.
        pad_pressure: shape (p,) [Pa]; None without a plane, or if the scene does not store it.
        plate_motion: of the plates' places and angles in their own frames, R^T dc and R^T dtheta, shape (p, plates, 6)
            [m, rad]; None without a load.
    """

    displacement: np.ndarray
    tip: np.ndarray
    channel_shortening: np.ndarray
    chamber_volumes: np.ndarray
    touch_distance: np.ndarray | None
    contact_force: np.ndarray | None
    pad_pressure: np.ndarray | None
    plate_motion: np.ndarray | None


def differentiate(problem: Problem, linearisation: Linearisation) -> Sensitivities:
    """Differentiate at the equilibrium that a problem is in, by the tangent there (collective)."""
    scene, forms = problem.scene, problem.forms
    count, plane, plates = len(scene.actuators), problem.distance is not None, problem.plates
    loads: list[tuple] = [(unit,) for unit in np.eye(count)] + ([(np.zeros(count), 1.0)] if plane else [])
    if plates is not None:
        units = np.eye(problem.wrenches.size).reshape(-1, *problem.wrenches.shape)
        loads += [(np.zeros(count), 0.0, unit) for unit in units]
    changes = np.array([-linearisation.solve(problem.load_gradient(*load)) for load in loads])
    conjugates = [_owned(problem.load_gradient(unit)) for unit in np.eye(count)]
    tips = [_owned(problem.tip_gradient(i)) for i in range(3)]
    contact_force = touch_distance = pad_pressure = None
    if plane and problem.contact is not None:
        contact_force = _along(problem, [_owned(problem.contact.force_gradient())], changes)[:, 0]
        contact_force[-1] -= problem.contact.stiffness()  # at fixed displacement
        pad = forms.contact[0]
        if pad.pad_gradient is not None and pad.pad_area is not None:
            # A plane that moves away is a finger that moves in the other direction: only the gap between them counts.
            lifted = problem.nodal(pad.pad_gradient)[: changes.shape[1] // 3, 1].sum()
            pad_pressure = _along(problem, [_owned(problem.gradient(pad.pad_gradient))], changes)[:, 0]
            pad_pressure[-1] -= problem.copies * problem.comm.allreduce(lifted)
            pad_pressure /= problem.scalar(pad.pad_area)
    elif scene.obstacle is not None and np.isfinite(problem.reach()):
        touch_distance = np.array([_reach_change(problem, change) for change in changes])
    tendons, reduced = len(scene.tendons), -_along(problem, conjugates, changes)  # lengths and -V, which fall
    return Sensitivities(
        displacement=changes,
        tip=_along(problem, tips, changes),
        channel_shortening=reduced[:, :tendons],
        chamber_volumes=reduced[:, tendons:],
        touch_distance=touch_distance,
        contact_force=contact_force,
        pad_pressure=pad_pressure,
        plate_motion=None if plates is None else _plate_motion(problem, plates, changes),
    )


def _plate_motion(problem: Problem, plates: PlateLoads, changes: np.ndarray) -> np.ndarray:
    poses = plates.poses(problem.displacement)
    return np.array([plates.motion(poses, change) for change in changes])


def _along(problem: Problem, gradients: list[np.ndarray], changes: np.ndarray) -> np.ndarray:
    """Changes of quantities of the whole finger, of whose gradients this rank has its own part: (p, quantities)."""
    return problem.copies * np.asarray(problem.comm.allreduce(changes @ np.array(gradients).T))


def _reach_change(problem: Problem, change: np.ndarray) -> float:
    """Directional derivative of the reach [m] by owned displacements, shape (3 nodes,).

    If several points reach equally far, the one that moves farthest decides.
    """
    whole = fem.Function(problem.space)
    whole.x.array[: len(change)] = change
    whole.x.scatter_forward()
    places, field = problem.surface_places(), problem.contact_points.field(whole.x.array)
    farthest, found = problem.reach() - 1e-9 * problem.scene.geometry.side, -np.inf
    for body in problem.bodies:
        reaches = body.touch_distance(places)
        leads = reaches > farthest
        normal = body.normal_at(places[leads], reaches[leads])
        moved = np.sum(normal * field[leads], axis=1) / (normal @ body.direction)
        found = max(found, float(moved.max(initial=-np.inf)))
    return float(problem.comm.allreduce(found, op=MPI.MAX))


def _owned(b: PETSc.Vec) -> np.ndarray:
    values = b.array_r.copy()
    b.destroy()
    return values
