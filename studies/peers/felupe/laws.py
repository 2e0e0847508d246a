"""The scene's energies as materials of FElupe; imported in FElupe's own process alone.

Neo-Hookean rubber, Yeoh's and steel are FElupe's own. It gets the second invariant of Mooney's and Rivlin's law as an
energy, which it differentiates itself (tensortrax). The tendon's fibre is written out.
"""

from __future__ import annotations

from typing import Any

import felupe
import numpy as np
from felupe.constitution import tensortrax as differentiated
from tensortrax.math import log, trace
from tensortrax.math.linalg import det


def materials(law: dict[str, Any]) -> tuple[Any, Any]:
    """A law, the scene's table [Pa, 1/Pa], as materials of FElupe: of distortion, and of (J - 1)^2 / D1."""
    bulk = felupe.NeoHooke(bulk=2 / law["D1"])
    if law["law"] == "neo-hookean":
        return felupe.NeoHooke(mu=2 * law["C1"]), bulk
    if law["law"] == "yeoh":
        constants = {"C10": law["C1"], "C20": law["C2"], "C30": law["C3"]}
        return differentiated.Hyperelastic(differentiated.models.hyperelastic.yeoh, **constants), bulk
    second = differentiated.Hyperelastic(second_invariant, C01=law["C01"])
    return felupe.NeoHooke(mu=2 * law["C10"]) & second, bulk


def second_invariant(C: Any, C01: float) -> Any:
    """C01 (I2 - 3 - 4 ln J) [J/m^3]."""
    return C01 * ((trace(C) ** 2 - trace(C @ C)) / 2 - 3 - 2 * log(det(C)))


class Fibre(felupe.ConstitutiveMaterial):
    """A fibre bundle along x of constant tension: W = tau |f|, f = F e_x.

    Stress P = tau n e_x^T and elasticity tau/|f| (1 - n n^T) on the column of e_x, with n = f / |f|.

    Attributes:
        density: tau, the tension over the channel's section [Pa].
    """

    def __init__(self) -> None:
        self.density = 0.0
        self.kwargs: dict[str, float] = {}  # FElupe requires them
        self.x = [np.eye(3), np.zeros(0)]

    def gradient(self, x: list[np.ndarray]) -> list[np.ndarray]:
        """First Piola-Kirchhoff stress [Pa], shape (3, 3, points, cells), and no state variables."""
        along = x[0][:, 0]
        stress = np.zeros_like(x[0])
        stress[:, 0] = self.density * along / np.linalg.norm(along, axis=0)
        return [stress, x[-1]]

    def hessian(self, x: list[np.ndarray]) -> list[np.ndarray]:
        """Derivative of the stress by F [Pa], shape (3, 3, 3, 3, points, cells)."""
        along = x[0][:, 0]
        length = np.linalg.norm(along, axis=0)
        n = along / length
        across = np.eye(3)[:, :, None, None] - n[:, None] * n[None]
        found = np.zeros((3, 3, *x[0].shape))
        found[:, 0, :, 0] = self.density * across / length
        return [found]
