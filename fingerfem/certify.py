"""A surrogate's answer beside the full-order model's, which begins at the surrogate's own displacement field."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.equilibrium.failures import LoadNotReached, NotConverged
from fingerfem.model import FingerModel
from fingerfem.scene.scene import Scene
from rom.native.answer import Answer
from rom.surrogate import Surrogate


@dataclass(frozen=True, kw_only=True)
class Certificate:
    """What a surrogate said at one point, and what is true on its mesh.

    Attributes:
        answer: the surrogate's.
        tip: displacement of the tip plate's centre by the full-order model, shape (3,) [m].
        contact_force: likewise [N]; None without a plane.
        factorisations: that the full-order model needed.
        began: where it began: `field`, the surrogate's; `free`, that of the free finger, to which the plane then came;
            or `rest`.
    """

    answer: Answer
    tip: np.ndarray
    contact_force: float | None
    factorisations: int
    began: str

    @property
    def errors(self) -> dict[str, float]:
        """True errors of tip [m] and contact force [N]."""
        found = {"tip": float(np.linalg.norm(self.answer.tip - self.tip))}
        if self.contact_force is not None:
            found["contact_force"] = abs(float(self.answer.contact_force) - self.contact_force)
        return found

    @property
    def covered(self) -> bool:
        """Whether the surrogate's own estimates cover them; they say nothing of a point that is not inside."""
        estimated = self.answer.error_parts["surrogate"]
        return bool(self.answer.inside) and all(error <= estimated[name] for name, error in self.errors.items())

    def as_json(self) -> dict[str, Any]:
        """Plain data: a quantity's surrogate, full-order value, error and estimated error, in [m] and [N]."""
        full_order = {"tip": self.tip.tolist(), "contact_force": self.contact_force}
        quantities = {
            name: {
                "surrogate": np.asarray(getattr(self.answer, name)).tolist(),
                "full_order": full_order[name],
                "error": error,
                "estimated_error": float(self.answer.error_parts["surrogate"][name]),
            }
            for name, error in self.errors.items()
        }
        return quantities | {
            "inside": bool(self.answer.inside),
            "covered": self.covered,
            "factorisations": self.factorisations,
            "began": self.began,
        }


class Certifier:
    """Solves with the full-order model what a surrogate answers.

    Args:
        model: it must know the displacement field.

    Raises:
        ValueError: it does not.
    """

    def __init__(self, model: Surrogate):
        if not model.has_field:
            raise ValueError("model must know the displacement to be certified (sampling.store), got one that does not")
        self.model, self.full_order = model, FingerModel(Scene.model_validate(model.scene))
        self._numbering = NodeOrder(self.full_order.problem)

    def certify(self, tensions: ArrayLike, distance: float | None = None) -> Certificate:
        """Both answers at tensions [N], shape (t,), and the plane's distance [m]; None leaves it away.

        Raises:
            ValueError: a tension or distance that the scene does not allow.
            LoadNotReached: the full-order model has no answer, from rest either.
        """
        full_order, pulled = self.full_order, np.asarray(tensions, float)
        full_order.check_loads(pulled, distance)
        newton, problem = full_order.continuation.newton, full_order.problem
        before, began = newton.factorisations, self._solve(pulled, distance)
        return Certificate(
            answer=self.model.evaluate(self._point(pulled, distance)),
            tip=problem.tip(),
            contact_force=None if distance is None or problem.contact is None else problem.contact.force(),
            factorisations=newton.factorisations - before,
            began=began,
        )

    def _point(self, pulled: np.ndarray, distance: float | None) -> np.ndarray:
        away = [np.inf if distance is None else distance] if self.model.has_obstacle else []
        return np.append(pulled, away)

    def _begin(self, pulled: np.ndarray, distance: float | None) -> None:
        field = self.model.displacement(self._point(pulled, distance))
        self.full_order.continuation.start(pulled, distance, self._numbering.scatter(field))

    def _solve(self, pulled: np.ndarray, distance: float | None) -> str:
        """Solve from the nearest start that leads there; which it was."""
        continuation = self.full_order.continuation
        self._begin(pulled, distance)
        with contextlib.suppress(NotConverged):
            continuation.newton.solve()
            return "field"
        try:  # which nodes press is not known to a micrometre: the plane comes
            self._begin(pulled, None)
            continuation.newton.solve()
            continuation.advance(pulled, distance)
            return "free"
        except (LoadNotReached, NotConverged):
            self.full_order.solve(pulled, distance, sensitivities=False)
            return "rest"
