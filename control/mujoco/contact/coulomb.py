"""Coulomb's law for contacts of fingers, in place of MuJoCo's convex relaxation.

In the relaxation a sliding body lifts off: its normal acceleration exceeds the reference by the friction coefficient
times the residual of the tangential acceleration. The correction of De Saxce and Feng (Math. Comput. Model. 28, 1998)
reduces the reference by this product, in a fixed-point iteration, so that the body slides along the surface.
"""

from __future__ import annotations

import mujoco
import numpy as np

REPETITIONS = 10  # largest number of iterations
CLOSE = 0.004  # largest change of the correction in the last iteration, over the reference [-]
SHARES = 0.1, 5.0  # smallest and largest share of a change that is applied [-]
TINY = float(np.finfo(float).tiny)
DIRECTIONS = np.arange(5)  # of friction: two tangential ones, torsion, two of rolling


def solve(model: mujoco.MjModel, data: mujoco.MjData, contacts: np.ndarray) -> bool:
    """Solve accelerations and constraint forces with corrected contacts, given by index, in place of mj_fwdConstraint.

    Returns:
        True if the iteration converged; else sliding bodies still lift off a little.
    """
    mujoco.mj_fwdConstraint(model, data)
    all_ = data.contact
    dimensions, addresses = all_.dim[contacts], all_.efc_address[contacts]
    own = (dimensions > 1) & (addresses >= 0)
    if not own.any():
        return True
    normal, frictional = addresses[own], dimensions[own, None] - 1 > DIRECTIONS
    along = np.minimum(normal[:, None] + 1 + DIRECTIONS, data.nefc - 1)
    friction = all_.friction[contacts][own] * frictional
    reference, forces = data.efc_aref, data.efc_force
    wanted, accelerations = reference[normal], np.empty(data.nefc)
    correction, last = np.zeros((2, len(normal)))
    share = 1.0
    for repetition in range(REPETITIONS):
        mujoco.mj_mulJacVec(model, data, accelerations, data.qacc)
        missing = friction * (accelerations[along] - reference[along] + data.efc_R[along] * forces[along])
        lifted = np.sqrt(np.einsum("ki,ki->k", missing, missing)) * (forces[normal] > 0)
        change = lifted - correction
        if np.all(np.abs(change) <= CLOSE * (np.abs(wanted) + lifted)):
            return True
        if repetition == REPETITIONS - 1:
            break
        if repetition:  # Aitken's relaxation of the fixed point (Irons and Tuck 1969)
            turned = last - change
            share = float(np.clip(share * (last @ turned) / max(turned @ turned, TINY), *SHARES))
        correction, last = np.maximum(correction + share * change, 0.0), change
        reference[normal] = wanted - correction
        data.qacc_warmstart[:] = data.qacc
        mujoco.mj_fwdConstraint(model, data)
    return False
