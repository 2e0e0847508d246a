"""Yeoh's law."""

from typing import Annotated, Any, Literal

from pydantic import Field

from fingerfem.scene.laws.formula import Invariants, Maths
from fingerfem.scene.laws.law import Law, registered
from fingerfem.scene.laws.quadratic_volume import QuadraticVolume

Constant = Annotated[float, Field(ge=-1e12, le=1e12)]  # [Pa]


@registered
class Yeoh(QuadraticVolume, Law):
    """W = C1 (I1bar - 3) + C2 (I1bar - 3)^2 + C3 (I1bar - 3)^3 + (J - 1)^2 / D1; C1 > 0, C2, C3 [Pa], D1 > 0 [1/Pa].

    Yeoh, Rubber Chem. Technol. 66, 1993, doi:10.5254/1.3538343. Polyconvex where no constant is below 0.
    """

    law: Literal["yeoh"] = "yeoh"
    C1: Annotated[float, Field(ge=1e2, le=1e12)]
    C2: Constant = 0.0
    C3: Constant = 0.0
    D1: Annotated[float, Field(ge=1e-13, le=1e-2)]

    def distortional(self, strain: Invariants, maths: Maths) -> Any:
        """The terms of I1bar - 3 [J/m^3]."""
        C1, C2, C3 = (maths.number(value) for value in (self.C1, self.C2, self.C3))
        excess = strain.I1bar - 3
        return excess * (C1 + excess * (C2 + excess * C3))

    @classmethod
    def constants(cls, mu: float, K: float, given: dict[str, Any]) -> dict[str, Any]:
        """C1 and D1 beside C2 and C3, which the moduli do not see."""
        return {"C1": mu / 2, "D1": 2 / K}

    @property
    def shear_modulus(self) -> float:
        """Mu = 2 C1 [Pa]."""
        return 2 * self.C1

    @property
    def is_always_stable(self) -> bool:
        """Polyconvex where no constant is below 0."""
        return min(self.C2, self.C3) >= 0
