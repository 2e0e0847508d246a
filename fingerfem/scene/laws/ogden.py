"""Ogden's law."""

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator

from fingerfem.scene.laws.formula import NUMPY, Invariants, Maths
from fingerfem.scene.laws.law import Law, registered
from fingerfem.scene.laws.power_sums import STRETCHES, power_sum
from fingerfem.scene.laws.quadratic_volume import QuadraticVolume

MOST_TERMS, LEAST = 4, 1e-2  # and smallest power in size [-]


@registered
class Ogden(QuadraticVolume, Law):
    """W = sum_p mu_p / alpha_p (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3) + (J - 1)^2 / D1, with isochoric stretches l.

    Ogden, Proc. R. Soc. Lond. A 326, 1972, doi:10.1098/rspa.1972.0026; mu_p [Pa], alpha_p [-], D1 [1/Pa]. Abaqus has
    2 mu_p / alpha_p^2 in place of mu_p / alpha_p. The powers are exact to 2e-8 between stretches of 0.2 and 5, see
    `power_sums`; states beyond are refused.
    """

    law: Literal["ogden"] = "ogden"
    mu: Annotated[list[Annotated[float, Field(ge=-1e12, le=1e12)]], Field(min_length=1, max_length=MOST_TERMS)]
    alpha: Annotated[list[Annotated[float, Field(ge=-30, le=30)]], Field(min_length=1, max_length=MOST_TERMS)]
    D1: Annotated[float, Field(ge=1e-13, le=1e-2)]

    @field_validator("alpha")
    @classmethod
    def _goes_with_mu(cls, alpha: list[float], info: ValidationInfo) -> list[float]:
        count = len(info.data.get("mu", alpha))
        if count != len(alpha):
            raise ValueError(f"must have as many numbers as mu ({count}), got {len(alpha)}")
        if min(map(abs, alpha)) < LEAST:
            raise ValueError(f"must be at least {LEAST:g} in size, got {min(alpha, key=abs):g}")
        return alpha

    def distortional(self, strain: Invariants, maths: Maths) -> Any:
        """The sum of powers of the isochoric stretches [J/m^3]."""
        I1bar, I2bar = strain.I1bar, strain.I2bar
        return sum(
            maths.number(mu / alpha)
            * (power_sum(alpha / 2, I1bar, I2bar, maths) - maths.number(power_sum(alpha / 2, 3.0, 3.0, NUMPY)))
            for mu, alpha in zip(self.mu, self.alpha, strict=True)
        )

    @classmethod
    def constants(cls, mu: float, K: float, given: dict[str, Any]) -> dict[str, Any]:
        """Mu of one term, by its alpha, and D1."""
        alpha = given.get("alpha", [0.0])
        if not (isinstance(alpha, list) and len(alpha) == 1 and isinstance(alpha[0], (int, float)) and alpha[0]):
            raise ValueError(f"alpha must be one number beside a modulus, [-] in brackets, got {given.get('alpha')}")
        return {"mu": [2 * mu / alpha[0]], "D1": 2 / K}

    @property
    def shear_modulus(self) -> float:
        """Mu = sum_p mu_p alpha_p / 2 [Pa]."""
        return sum(mu * alpha for mu, alpha in zip(self.mu, self.alpha, strict=False)) / 2

    @property
    def limits(self) -> tuple[float, float]:
        """Stretches between which fractional powers are exact [-]."""
        return STRETCHES
