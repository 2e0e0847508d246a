"""How the plates move with tensions and with wrenches on them: Jacobian and compliance of the condensed finger."""

from __future__ import annotations

import numpy as np

from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.linearisation import Linearisation


def plate_motion(problem: Problem, linearisation: Linearisation) -> np.ndarray:
    """Derivatives of the plates' places and angles in their own frames, R^T dc and R^T dtheta (collective).

    Args:
        problem: in equilibrium, of a scene with a load.
        linearisation: the tangent there, following loads included.

    Returns:
        by tensions, then by the components of the wrenches on the plates from clamp to tip, shape
        (tensions + 6 plates, plates, 6) [m/N, rad/N; m/(N m), rad/(N m)].
    """
    assert problem.plates is not None, "of a scene with a load"
    poses, found = problem.plates.poses(problem.displacement), []
    count = len(problem.tensions)
    for unit in np.eye(count + problem.wrenches.size):
        wrenches = unit[count:].reshape(problem.wrenches.shape)
        change = -linearisation.solve(problem.load_gradient(unit[:count], 0.0, wrenches))
        found.append(problem.plates.motion(poses, change))
    return np.array(found)
