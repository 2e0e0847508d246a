"""Laws of the rubber: parameters, their range, small-strain moduli. Their energies: `mechanics.strain_energy`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from fingerfem.scene.law_stability import LONGEST, SHORTEST, Constants, first_loss

Formulation = Literal["displacement", "mixed"]
NEARLY_INCOMPRESSIBLE = 0.45  # Poisson's ratio above which displacements alone begin to lock


class SceneTable(BaseModel):
    """A table of the scene: every key known, nothing converted silently, nothing changed afterwards."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Law(SceneTable):
    """Any isotropic law, by its shear modulus mu and bulk modulus K at small strain [Pa].

    Attributes:
        formulation: `mixed` takes a pressure for an unknown of its own; chosen by Poisson's ratio if left out.
    """

    formulation: Formulation | None = None

    @model_validator(mode="after")
    def _has_moduli(self) -> Law:
        if not min(self.shear_modulus, self.bulk_modulus) > 0:
            raise ValueError(
                "law must have a shear and a bulk modulus above 0 Pa at small strain, "
                f"got {self.shear_modulus:.3g} and {self.bulk_modulus:.3g}"
            )
        if self.poisson < -1e-9:
            raise ValueError(
                "law must have a Poisson's ratio of at least 0, below which coarse cells lock in shear, "
                f"got {self.poisson:.3g}"
            )
        return self

    @property
    def shear_modulus(self) -> float:
        """Mu [Pa], at small strain."""
        raise NotImplementedError

    @property
    def bulk_modulus(self) -> float:
        """K [Pa], at small strain."""
        raise NotImplementedError

    @property
    def young_modulus(self) -> float:
        """E = 9 K mu / (3 K + mu) [Pa], at small strain."""
        mu, K = self.shear_modulus, self.bulk_modulus
        return 9 * K * mu / (3 * K + mu)

    @property
    def poisson(self) -> float:
        """Nu = (3 K - 2 mu) / (6 K + 2 mu) [-], at small strain."""
        mu, K = self.shear_modulus, self.bulk_modulus
        return (3 * K - 2 * mu) / (6 * K + 2 * mu)

    @property
    def p_wave_modulus(self) -> float:
        """M = K + 4/3 mu [Pa], of uniaxial strain."""
        return self.bulk_modulus + 4 / 3 * self.shear_modulus

    @property
    def smallest_stretch(self) -> float:
        """The least principal stretch that the law is good for [-]; 0 for all."""
        return 0.0

    @property
    def is_mixed(self) -> bool:
        """Whether the pressure is an unknown of its own."""
        return (self.formulation or ("mixed" if self.poisson > NEARLY_INCOMPRESSIBLE else "displacement")) == "mixed"


class NeoHookean(Law):
    """W = C1 (I1bar - 3) + (J - 1)^2 / D1, polyconvex for all positive C1 [Pa] and D1 [1/Pa].

    Chenevier et al., PLoS ONE 13(2): e0192052 (2018), eq. 4, read so that its units fit.
    """

    law: Literal["neo-hookean"] = "neo-hookean"
    C1: Annotated[float, Field(ge=1e2, le=1e12)]
    D1: Annotated[float, Field(ge=1e-13, le=1e-2)]

    @property
    def shear_modulus(self) -> float:
        """Mu = 2 C1 [Pa]."""
        return 2 * self.C1

    @property
    def bulk_modulus(self) -> float:
        """K = 2 / D1 [Pa]."""
        return 2 / self.D1


class MooneyRivlin(Law):
    """W = C10 (I1bar - 3) + C01 (I2 - 3 - 4 ln J) + (J - 1)^2 / D1, for C10 > 0, C01 [Pa] and D1 > 0 [1/Pa].

    At J = 1 it is Mooney's and Rivlin's law. The usual compressible form has I2bar = J^(-4/3) I2 instead, which is not
    polyconvex (Hartmann, Neff, Int. J. Solids Struct. 40, 2003, doi:10.1016/S0020-7683(03)00086-6); I2 - 4 ln J is:
    the squared cofactor plus a convex function of J. That needs C01 >= 0. Fits of measured rubber often have C01 < 0;
    such a law is accepted where it is stable in all stretches of `law_stability`.
    """

    law: Literal["mooney-rivlin"] = "mooney-rivlin"
    C10: Annotated[float, Field(ge=1e2, le=1e12)]
    C01: Annotated[float, Field(ge=-1e12, le=1e12)]
    D1: Annotated[float, Field(ge=1e-13, le=1e-2)]

    @model_validator(mode="after")
    def _is_stable(self) -> MooneyRivlin:
        lost = None if self.C01 >= 0 else first_loss(Constants(self.C10, self.C01, self.D1))
        if lost is not None:
            raise ValueError(
                f"law must be stable at all stretches from {SHORTEST} to {LONGEST}, got C01 = {self.C01:g} Pa and "
                f"C10 = {self.C10:g} Pa, which lose stability at {lost[1]:.3f} in {lost[0]} stretch; "
                "raise C01 or lower D1"
            )
        return self

    @property
    def shear_modulus(self) -> float:
        """Mu = 2 (C10 + C01) [Pa]."""
        return 2 * (self.C10 + self.C01)

    @property
    def bulk_modulus(self) -> float:
        """K = 2 / D1 + 16/3 C01 [Pa]."""
        return 2 / self.D1 + 16 / 3 * self.C01


class SaintVenantKirchhoff(Law):
    """W = lambda/2 (tr e)^2 + mu tr e^2, with e = (C - I)/2: Hooke's law at any rotation, for small strains.

    Parameters are Young's modulus E [Pa] and Poisson's ratio nu [-].
    It has no polyconvex range and softens under compression: pressed along one axis to a stretch l it answers with
    E (l^3 - l) / 2, which falls again below l = 1 / sqrt(3); so it does with its sides held. It has no volumetric part
    to split off, so it stays below the Poisson's ratio that would need one.
    """

    law: Literal["saint-venant-kirchhoff"] = "saint-venant-kirchhoff"
    formulation: Literal["displacement"] | None = None
    E: Annotated[float, Field(ge=1e2, le=1e12)]
    nu: Annotated[float, Field(ge=0, le=NEARLY_INCOMPRESSIBLE)]

    @property
    def shear_modulus(self) -> float:
        """Mu = E / (2 + 2 nu) [Pa]."""
        return self.E / (2 + 2 * self.nu)

    @property
    def bulk_modulus(self) -> float:
        """K = E / (3 - 6 nu) [Pa]."""
        return self.E / (3 - 6 * self.nu)

    @property
    def smallest_stretch(self) -> float:
        """1 / sqrt(3) [-], below which it loses its stiffness."""
        return 3**-0.5

    @property
    def poisson(self) -> float:
        """Nu [-], without the round-off of computing it from moduli."""
        return self.nu


def neo_hookean_from(young_modulus: float, poisson: float) -> NeoHookean:
    """The neo-Hookean law with the given small-strain moduli E [Pa] and nu [-]."""
    return NeoHookean(C1=young_modulus / (4 * (1 + poisson)), D1=6 * (1 - 2 * poisson) / young_modulus)


STEEL = neo_hookean_from(young_modulus=200e9, poisson=0.3)
RIGID = 1e6  # times the rubber's modulus: a plate bends by a millionth of what the rubber does


def plate_law(rubber: Law) -> NeoHookean:
    """Steel, or RIGID times the rubber where that is softer: of stiffer plates, round-off hides the rubber's stress."""
    return neo_hookean_from(young_modulus=min(STEEL.young_modulus, RIGID * rubber.young_modulus), poisson=0.3)
