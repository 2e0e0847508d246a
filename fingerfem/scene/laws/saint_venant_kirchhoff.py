"""The law of Saint Venant and Kirchhoff, for small strains."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from fingerfem.scene.laws.formula import Invariants, Maths
from fingerfem.scene.laws.law import NEARLY_INCOMPRESSIBLE, Law, registered


@registered
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

    def distortional(self, strain: Invariants, maths: Maths) -> Any:
        """The whole energy [J/m^3], by tr e = (I1 - 3) / 2 and tr e^2 = (I1^2 - 2 I2 - 2 I1 + 3) / 4."""
        mu, lame = maths.number(self.shear_modulus), maths.number(self.bulk_modulus - 2 / 3 * self.shear_modulus)
        excess, squares = strain.I1 - 3, strain.I1**2 - 2 * strain.I2 - 2 * strain.I1 + 3
        return lame / 8 * excess**2 + mu / 4 * squares

    @property
    def shear_modulus(self) -> float:
        """Mu = E / (2 + 2 nu) [Pa]."""
        return self.E / (2 + 2 * self.nu)

    @property
    def bulk_modulus(self) -> float:
        """K = E / (3 - 6 nu) [Pa]."""
        return self.E / (3 - 6 * self.nu)

    @property
    def limits(self) -> tuple[float, float]:
        """1 / sqrt(3) [-], below which it loses its stiffness."""
        return 3**-0.5, np.inf

    @property
    def is_always_stable(self) -> bool:
        """True: the law's limits exclude states that are not stable."""
        return True

    @property
    def poisson(self) -> float:
        """Nu [-], without the round-off of computing it from moduli."""
        return self.nu
