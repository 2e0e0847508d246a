"""The law of Mooney and Rivlin."""

from typing import Annotated, Any, Literal

from pydantic import Field

from fingerfem.scene.laws.formula import Invariants, Maths
from fingerfem.scene.laws.law import Law, registered


@registered
class MooneyRivlin(Law):
    """W = C10 (I1bar - 3) + C01 (I2 - 3 - 4 ln J) + (J - 1)^2 / D1, for C10 > 0, C01 [Pa] and D1 > 0 [1/Pa].

    At J = 1 it is Mooney's and Rivlin's law. The usual compressible form has I2bar = J^(-4/3) I2 instead, which is not
    polyconvex (Hartmann, Neff, Int. J. Solids Struct. 40, 2003, doi:10.1016/S0020-7683(03)00086-6); I2 - 4 ln J is:
    the squared cofactor plus a convex function of J. That needs C01 >= 0. Fits of measured rubber often have C01 < 0;
    such a law is accepted where it is stable.
    """

    law: Literal["mooney-rivlin"] = "mooney-rivlin"
    C10: Annotated[float, Field(ge=1e2, le=1e12)]
    C01: Annotated[float, Field(ge=-1e12, le=1e12)]
    D1: Annotated[float, Field(ge=1e-13, le=1e-2)]

    # C01 (I2 - 3 - 4 ln J) resists a change of volume too, by 16/3 C01 at rest. That part belongs to the pressure: with
    # C01 < 0 it would soften what the pressure's few points do not see.
    def distortional(self, strain: Invariants, maths: Maths) -> Any:
        """C10 (I1bar - 3) + C01 (I2 - 3 J^(4/3)) [J/m^3]."""
        C10, C01 = maths.number(self.C10), maths.number(self.C01)
        return C10 * (strain.I1bar - 3) + C01 * (strain.I2 - 3 * strain.J ** (4 / 3))

    def volumetric(self, J: Any, maths: Maths) -> Any:
        """(J - 1)^2 / D1 + C01 (3 J^(4/3) - 3 - 4 ln J) [J/m^3]."""
        D1, C01 = maths.number(self.D1), maths.number(self.C01)
        return (J - 1) ** 2 / D1 + C01 * (3 * J ** (4 / 3) - 3 - 4 * maths.ln(J))

    @classmethod
    def constants(cls, mu: float, K: float, given: dict[str, Any]) -> dict[str, Any]:
        """C10 and D1 beside a C01, which is 0 if left out."""
        C01 = given.get("C01", 0.0)
        if not isinstance(C01, (int, float)) or K <= 16 / 3 * C01:
            raise ValueError(f"C01 must be a number below 3/16 of the bulk modulus ({K:.3g} Pa), got {C01!r}")
        return {"C10": mu / 2 - C01, "D1": 2 / (K - 16 / 3 * C01)} | ({} if "C01" in given else {"C01": 0.0})

    @property
    def shear_modulus(self) -> float:
        """Mu = 2 (C10 + C01) [Pa]."""
        return 2 * (self.C10 + self.C01)

    @property
    def bulk_modulus(self) -> float:
        """K = 2 / D1 + 16/3 C01 [Pa]."""
        return 2 / self.D1 + 16 / 3 * self.C01

    @property
    def is_always_stable(self) -> bool:
        """Polyconvex for C01 >= 0."""
        return self.C01 >= 0
