"""A first estimate of the clamp's pose in the measuring frame, from positions and orientations of the tip."""

import numpy as np
from scipy.spatial.transform import Rotation

from control.calibration.fit import first_tensions
from control.calibration.measured import GROUPS, Measured
from control.calibration.parameters import PLACE, TURN

FLAT = 1e-6  # second singular value of the positions' spread, over the first: they lie on a line [-]


def first_base(measured: Measured) -> dict[str, float]:
    """Starting values of the base's parameters, those of the finger at its starting parameters (Kabsch 1976)."""
    none = np.zeros(len(measured.unknowns.names))
    sigma = {name: GROUPS[name][1] for name in measured.groups}
    outputs = measured.outputs(none, first_tensions(measured, none, sigma))
    turn, place = Rotation.identity(), np.zeros(3)
    oriented = np.isfinite(measured.log.orientation).all(axis=1)
    placed = np.isfinite(measured.log.position).all(axis=1)
    if oriented.any():
        seen, own = (one[oriented][:, [1, 2, 3, 0]] for one in (measured.log.orientation, outputs.orientation))
        turn = (Rotation.from_quat(seen) * Rotation.from_quat(own).inv()).mean()
    elif placed.sum() > 2:
        turn = _aligned(measured.log.position[placed], outputs.position[placed])
    if placed.any():
        place = (measured.log.position[placed] - turn.apply(outputs.position[placed])).mean(axis=0)
    return dict(zip((*PLACE, *TURN), (*place.tolist(), *turn.as_rotvec().tolist()), strict=True))


def _aligned(seen: np.ndarray, own: np.ndarray) -> Rotation:
    """The rotation that fits own positions to seen ones best; none if they lie on a line."""
    first, second = (one - one.mean(axis=0) for one in (seen, own))
    values = np.linalg.svd(second, compute_uv=False)
    return Rotation.align_vectors(first, second)[0] if values[1] > FLAT * values[0] else Rotation.identity()
