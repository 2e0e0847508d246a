"""Sums of powers of the principal stretches, from the invariants alone.

Formulas with the stretches themselves have derivatives that divide by the differences of stretches: 0 at rest and in
uniaxial stretch. The sum S_k = b1^(f+k) + b2^(f+k) + b3^(f+k) of powers of the three eigenvalues b of an isochoric C
obeys, as b^3 = I1 b^2 - I2 b + 1,

    S_(k+1) = I1 S_k - I2 S_(k-1) + S_(k-2).

For f = 0 it begins with I2, 3, I1. For 0 < f < 1, b^f is c0 + c1 b + sum_i w_i / (b + t_i) to ERROR, and

    sum over the eigenvalues of 1 / (b + t) = (3 t^2 + 2 I1 t + I2) / (t^3 + I1 t^2 + I2 t + 1).

That is a rational function of the invariants, smooth everywhere. Weights are fitted to the relative error.
"""

from functools import cache
from typing import Any

import numpy as np

from fingerfem.scene.laws.formula import Maths

STRETCHES = (0.2, 5.0)  # between which fractional powers are exact to ERROR [-]
ERROR = 2e-8  # relative, of the power of an eigenvalue [-]
POLES = np.geomspace(STRETCHES[0] ** 3.2, STRETCHES[1] ** 3.2, 14)  # t_i; fitted for the least error
NODES = 1001  # of eigenvalues that the weights are fitted at


@cache
def weights(fraction: float) -> np.ndarray:
    """c0, c1 and w_i of b^fraction, shape (16,)."""
    b = np.geomspace(STRETCHES[0] ** 2, STRETCHES[1] ** 2, NODES)
    terms = np.column_stack([np.ones(NODES), b, POLES / (b[:, None] + POLES)]) / (b**fraction)[:, None]
    scale = np.linalg.norm(terms, axis=0)
    solution = np.linalg.lstsq(terms / scale, np.ones(NODES), rcond=1e-15)[0] / scale
    return np.concatenate([solution[:2], solution[2:] * POLES])


def power_sum(power: float, I1: Any, I2: Any, maths: Maths) -> Any:
    """The sum of the eigenvalues' powers [-], of invariants of an isochoric C."""
    whole = int(np.floor(power))
    fraction = power - whole
    below, here, above = _fractional(fraction, I1, I2, maths) if fraction else (I2, 3.0, I1)
    for _ in range(whole):
        below, here, above = here, above, I1 * above - I2 * here + below
    for _ in range(-whole):
        below, here, above = above - I1 * here + I2 * below, below, here
    return here


def _fractional(fraction: float, I1: Any, I2: Any, maths: Maths) -> tuple[Any, Any, Any]:
    """S_-1, S_0 and S_1."""
    c0, c1, *w = (maths.number(float(value)) for value in weights(fraction))
    sums = [(3 * t**2 + 2 * t * I1 + I2) / (t**3 + t**2 * I1 + t * I2 + 1) for t in POLES.tolist()]
    each = list(zip(POLES.tolist(), w, sums, strict=True))
    here = 3 * c0 + c1 * I1 + sum(wi * si for _, wi, si in each)
    above = c0 * I1 + c1 * (I1**2 - 2 * I2) + sum(wi * (3 - t * si) for t, wi, si in each)
    below = c0 * I2 + 3 * c1 + sum(wi / t * (I2 - si) for t, wi, si in each)
    return below, here, above
