"""Tests of rubbers whose laws are known."""

from collections.abc import Sequence

import numpy as np

from fingerfem.material_fit.measurements import Measurement
from fingerfem.material_fit.stresses import EXPONENTS, nominal_stress, pulled
from fingerfem.scene.laws import Law, MooneyRivlin, NeoHookean, Ogden, Yeoh

MODES = ("uniaxial", "equibiaxial", "planar")
KNOWN = {
    "neo-hookean": NeoHookean(C1=1e5, D1=1e-8),
    "mooney-rivlin": MooneyRivlin(C10=1e5, C01=2e4, D1=1e-8),
    "yeoh": Yeoh(C1=1e5, C2=-1e3, C3=6e2, D1=1e-8),
    "ogden": Ogden(mu=[1.2e5, -2e4], alpha=[1.3, -2.0], D1=1e-8),
}


def exact(law: Law, mode: str, stretch: np.ndarray) -> np.ndarray:
    """Nominal stress; of Ogden's law by its powers, which the law itself has to 2e-8."""
    if not isinstance(law, Ogden):
        return nominal_stress(law, mode, stretch)
    terms = [(mu, alpha, k) for mu, alpha in zip(law.mu, law.alpha, strict=True) for k in EXPONENTS[mode]]
    return sum(mu * k * stretch ** (alpha * k - 1) for mu, alpha, k in terms) / pulled(mode)


def measured(
    law: Law, modes: Sequence[str] = MODES, noise: float = 0.0, seed: int = 0, count: int = 60
) -> list[Measurement]:
    """Tests up to a stretch of 2; the noise is of the peak."""
    found, random = [], np.random.default_rng(seed)
    for mode in modes:
        stretch = np.linspace(1.02, 2.0, count)
        stress = exact(law, mode, stretch)
        found.append(
            Measurement(mode=mode, stretch=stretch, stress=stress + noise * stress.max() * random.normal(size=count))
        )
    return found
