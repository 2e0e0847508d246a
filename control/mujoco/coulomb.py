"""Coulomb's law for the contacts of plates, which MuJoCo has in a convex relaxation only.

There forces and relative accelerations are dual to each other, and what slides is lifted off: its normal acceleration
is larger than wanted by the friction times the tangential one that is missing. Wanted is then less by as much, found
by repetition, as De Saxce and Feng have it (Math. Comput. Model. 28, 1998): what is left slides along the surface.
"""

from __future__ import annotations

import mujoco
import numpy as np

REPETITIONS = 10  # at most
CLOSE = 0.01  # of what is wanted, by which a repetition changes it: enough [-]
DIRECTIONS = np.arange(5)  # of friction: two along the surface, then turning and rolling, as many as a contact has


def correct(model: mujoco.MjModel, data: mujoco.MjData, contacts: np.ndarray) -> bool:
    """Correct what MuJoCo wants of contacts, by number, between its mj_step1 and mj_step2.

    Returns:
        whether it settled; if not, what slides is lifted off a little all the same.
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
