"""The neo-Hookean law, and plates' steel."""

from typing import Annotated, Any, Literal

from pydantic import Field

from fingerfem.scene.laws.formula import Invariants, Maths
from fingerfem.scene.laws.law import Law, registered
from fingerfem.scene.laws.quadratic_volume import QuadraticVolume


@registered
class NeoHookean(QuadraticVolume, Law):
    """W = C1 (I1bar - 3) + (J - 1)^2 / D1, polyconvex for all positive C1 [Pa] and D1 [1/Pa].

    Chenevier et al., PLoS ONE 13(2): e0192052 (2018), eq. 4, read so that its units fit.
    """

    law: Literal["neo-hookean"] = "neo-hookean"
    C1: Annotated[float, Field(ge=1e2, le=1e12)]
    D1: Annotated[float, Field(ge=1e-13, le=1e-2)]

    def distortional(self, strain: Invariants, maths: Maths) -> Any:
        """C1 (I1bar - 3) [J/m^3]."""
        return maths.number(self.C1) * (strain.I1bar - 3)

    @classmethod
    def constants(cls, mu: float, K: float, given: dict[str, Any]) -> dict[str, Any]:
        """C1 and D1."""
        return {"C1": mu / 2, "D1": 2 / K}

    @property
    def shear_modulus(self) -> float:
        """Mu = 2 C1 [Pa]."""
        return 2 * self.C1

    @property
    def is_always_stable(self) -> bool:
        """Polyconvex."""
        return True


def neo_hookean_from(young_modulus: float, poisson: float) -> NeoHookean:
    """The neo-Hookean law with the given small-strain moduli E [Pa] and nu [-]."""
    return NeoHookean(C1=young_modulus / (4 * (1 + poisson)), D1=6 * (1 - 2 * poisson) / young_modulus)


STEEL = neo_hookean_from(young_modulus=200e9, poisson=0.3)
RIGID = 1e6  # times the rubber's modulus: a plate bends by a millionth of what the rubber does


def plate_law(rubber: Law) -> NeoHookean:
    """Steel, or RIGID times the rubber where that is softer: of stiffer plates, round-off hides the rubber's stress."""
    return neo_hookean_from(young_modulus=min(STEEL.young_modulus, RIGID * rubber.young_modulus), poisson=0.3)
