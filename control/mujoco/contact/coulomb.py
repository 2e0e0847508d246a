"""Coulomb's law for contacts of fingers, in place of MuJoCo's convex relaxation.

In the relaxation a sliding body lifts off: its normal acceleration exceeds the reference by the friction coefficient
times the residual of the tangential acceleration. The correction of De Saxce and Feng (Math. Comput. Model. 28, 1998)
reduces the reference by this product, in a fixed-point iteration, so that the body slides along the surface.
"""

from __future__ import annotations

import mujoco
import numpy as np

from control.mujoco.contact.engine import Engine
from control.native import CONTROL
from rom.native import pointer

CLOSE = 0.004  # largest change of the correction in the last iteration, over the reference [-]


def solve(engine: Engine, own: np.ndarray) -> bool:
    """Solve accelerations and constraint forces in place of mj_fwdConstraint, after `Engine.set_constraints`.

    Args:
        engine: the model's.
        own: of which geoms contacts are corrected, shape (geoms,), bool.

    Returns:
        True if the iteration converged; else sliding bodies still lift off a little.
    """
    model, data, new = engine.model, engine.data, CONTROL.ffi.new
    slips, share, of = new("control_slip[]", data.ncon), new("double *"), pointer(own, "uint8_t[]")
    for solved in range(CONTROL.constants.CONTROL_SOLVES):
        if solved:
            data.qacc_warmstart[:] = data.qacc
        mujoco.mj_fwdConstraint(model, data)
        if CONTROL.functions.control_slide(engine.struct, of, solved, CLOSE, slips, share):
            return True
    return False
