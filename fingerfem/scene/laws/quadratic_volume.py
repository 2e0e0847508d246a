"""The energy of a change of volume that most laws share."""

from typing import TYPE_CHECKING, Any

from fingerfem.scene.laws.formula import Maths


class QuadraticVolume:
    """U(J) = (J - 1)^2 / D1, of laws with the constant D1 [1/Pa]."""

    if TYPE_CHECKING:  # a law names its constants itself, in their order
        D1: float

    def volumetric(self, J: Any, maths: Maths) -> Any:
        """(J - 1)^2 / D1 [J/m^3]."""
        return (J - 1) ** 2 / maths.number(self.D1)

    @property
    def bulk_modulus(self) -> float:
        """K = 2 / D1 [Pa]."""
        return float(2 / self.D1)
