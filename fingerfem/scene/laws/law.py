"""A law of the rubber: its constants and its energy, in formulas that UFL and NumPy share."""

from __future__ import annotations

import json
import warnings
from abc import ABC, abstractmethod
from functools import lru_cache
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    Field,
    SerializeAsAny,
    SerializerFunctionWrapHandler,
    WrapValidator,
    model_serializer,
    model_validator,
)

from fingerfem.scene.laws.formula import NUMPY, Invariants, Maths
from fingerfem.scene.laws.hardness import with_modulus
from fingerfem.scene.laws.stability import first_loss
from fingerfem.scene.scene_table import SceneTable

Formulation = Literal["displacement", "mixed"]
Branch = Annotated[list[Annotated[float, Field(ge=1e-9, le=1e9)]], Field(min_length=2, max_length=2)]  # [-], [s]
Stretch = Annotated[float, Field(gt=0.05, lt=20)]  # [-]
NEARLY_INCOMPRESSIBLE = 0.45  # Poisson's ratio above which displacements alone begin to lock
# Principal stretches between which a law must be stable if it gives no `stretches` [-]. The draft finger, bent by 100 N
# on one tendon, has 0.72 to 1.15.
USUAL_STRETCHES = (0.7, 1.5)
REGISTERED: dict[str, type[Law]] = {}  # by name


def registered(law: type[Law]) -> type[Law]:
    """Register a law, so that scenes can select it by the default value of its key `law`."""
    REGISTERED[law.model_fields["law"].default] = law
    return law


class Law(SceneTable, ABC):
    """An isotropic law W(I1, I2, J) + U(J), where U alone grows without bound as the rubber becomes incompressible.

    A scene may give E [Pa] or the hardness shore_A, and nu, in place of the constants of small strain.

    Attributes:
        law: its name.
        formulation: `mixed` adds the pressure as a separate unknown; if omitted, Poisson's ratio decides.
        stretches: lowest and highest principal stretch of the data that the constants were fitted to [-]. The law must
            be stable between them. States beyond them are marked.
        prony: branches of linear viscoelasticity, each a modulus over the law's own [-] and a relaxation time [s]. They
            act on the stress of `distortional`. The law itself is what is left after all relaxation.
    """

    law: str
    formulation: Formulation | None = None
    stretches: Annotated[list[Stretch], Field(min_length=2, max_length=2)] | None = None
    prony: Annotated[list[Branch], Field(min_length=1, max_length=8)] | None = None

    @property
    @abstractmethod
    def shear_modulus(self) -> float:
        """Mu [Pa], at small strain."""

    @property
    @abstractmethod
    def bulk_modulus(self) -> float:
        """K [Pa], at small strain."""

    @abstractmethod
    def distortional(self, strain: Invariants, maths: Maths) -> Any:
        """W(I1, I2, J) [J/m^3], without stiffness against small changes of volume; without U, the whole energy."""

    def volumetric(self, J: Any, maths: Maths) -> Any | None:
        """U(J) [J/m^3], or None if the law has no such part."""
        return None

    @classmethod
    def constants(cls, mu: float, K: float, given: dict[str, Any]) -> dict[str, Any]:
        """Constants that give these moduli [Pa], together with those already given; empty if the law has none."""
        return {}

    @property
    def is_always_stable(self) -> bool:
        """True if the check of stability can be skipped, because the energy is polyconvex."""
        return False

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest principal stretch between which the law has an answer [-]."""
        return 0.0, np.inf

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
    def is_mixed(self) -> bool:
        """True if the pressure is a separate unknown."""
        return (self.formulation or ("mixed" if self.poisson > NEARLY_INCOMPRESSIBLE else "displacement")) == "mixed"

    @model_serializer(mode="wrap")
    def _without_what_is_not_given(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Omit `stretches` and `prony` if they are not given, so that such laws keep their fingerprint."""
        later = "stretches", "prony"
        return {key: value for key, value in serialise(self).items() if key not in later or value is not None}

    @model_validator(mode="before")
    @classmethod
    def _by_modulus(cls, table: Any) -> Any:
        has_moduli = cls.constants.__func__ is not Law.constants.__func__  # type: ignore[attr-defined]
        return with_modulus(table, cls.constants) if has_moduli and isinstance(table, dict) else table

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

    @model_validator(mode="after")
    def _bends_without_locking(self) -> Law:
        if self.poisson > NEARLY_INCOMPRESSIBLE and not self.is_mixed:
            warnings.warn(
                f"material.formulation = displacement makes cells too stiff at nu = {self.poisson:.6g}, of order 1 "
                "several times: leave it out",
                stacklevel=2,
            )
        return self

    @model_validator(mode="after")
    def _has_what_relaxes(self) -> Law:
        if self.prony is not None and self.volumetric(1.0, NUMPY) is None:
            raise ValueError(
                f"prony must be left out of a law without a volumetric part ({self.law}), got {self.prony}"
            )
        return self

    @model_validator(mode="after")
    def _is_stable(self) -> Law:
        low, high = self.stretches or USUAL_STRETCHES
        if not low < 1 < high:
            raise ValueError(f"stretches must be [lowest, highest] with 1 between them, got {[low, high]}")
        constants = self.model_dump_json(exclude={"stretches", "formulation"})
        lost = None if self.is_always_stable else loss_of_constants(type(self), constants, (low, high))
        if lost is not None:
            own = ", ".join(
                f"{name} = {value:g}" if isinstance(value, float) else f"{name} = {value}"
                for name, value in self
                if name not in Law.model_fields
            )
            raise ValueError(
                f"law must be stable at all stretches from {low:g} to {high:g}, got {own}, "
                f"which lose stability at {lost[1]:.3f} in {lost[0]} stretch; narrow stretches, or fit anew"
            )
        return self


@lru_cache(maxsize=1000)
def loss_of_constants(law: type[Law], constants: str, stretches: tuple[float, float]) -> tuple[str, float] | None:
    """`first_loss` of a law by its constants as JSON: it takes up to a second, and scenes are validated often."""
    return first_loss(law.model_construct(**json.loads(constants)), stretches)


def _by_name(table: Any, check: Any) -> Law:
    """The law that a table names."""
    if isinstance(table, Law) or not isinstance(table, dict):
        return check(table)
    name = table.get("law")
    if name is None:
        raise ValueError("law is required and missing")
    if not isinstance(name, str) or name not in REGISTERED:
        raise ValueError(f"law must be {' or '.join(map(repr, REGISTERED))}, got {name!r}")
    return REGISTERED[name].model_validate(table)


NamedLaw = Annotated[SerializeAsAny[Law], WrapValidator(_by_name)]  # a table of a scene
