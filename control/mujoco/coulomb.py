"""Coulomb's law for contacts of fingers, in place of MuJoCo's convex relaxation.

In the relaxation a sliding body lifts off: its normal acceleration exceeds the reference by the friction coefficient
times the residual of the tangential acceleration. The correction of De Saxce and Feng (Math. Comput. Model. 28, 1998)
reduces the reference by this product, in a fixed-point iteration, so that the body slides along the surface.
"""

from __future__ import annotations

import mujoco
import numpy as np

REPETITIONS = 10  # largest number of iterations
CLOSE = 0.01  # largest change of the correction in the last iteration, over the reference [-]
DIRECTIONS = np.arange(5)  # of friction: two tangential ones, torsion, two of rolling


def correct(model: mujoco.MjModel, data: mujoco.MjData, contacts: np.ndarray) -> bool:
    """Correct the reference accelerations of contacts, given by index, between MuJoCo's mj_step1 and mj_step2.

    Returns:
        Whether the iteration converged; if not, sliding bodies still lift off a little.
    """
    all_ = data.contact
    own = contacts[(all_.dim[contacts] > 1) & (all_.efc_address[contacts] >= 0)]
    if not len(own):
        return True
    normal, frictional = all_.efc_address[own], all_.dim[own, None] - 1 > DIRECTIONS
    along = np.minimum(normal[:, None] + 1 + DIRECTIONS, data.nefc - 1)
    friction = all_.friction[own] * frictional
    wanted, accelerations = data.efc_aref[normal].copy(), np.empty(data.nefc)
    before = np.zeros(len(own))
    mujoco.mj_fwdActuation(model, data)
    mujoco.mj_fwdAcceleration(model, data)
    for _ in range(REPETITIONS):
        mujoco.mj_fwdConstraint(model, data)
        mujoco.mj_mulJacVec(model, data, accelerations, data.qacc)
        missing = friction * (accelerations - data.efc_aref)[along]
        lifted = np.sqrt(np.einsum("ki,ki->k", missing, missing)) * (data.efc_force[normal] > 0)
        data.efc_aref[normal] = wanted - lifted
        data.qacc_warmstart[:] = data.qacc
        if np.all(np.abs(lifted - before) <= CLOSE * (np.abs(wanted) + lifted)):
            return True
        before = lifted
    return False
