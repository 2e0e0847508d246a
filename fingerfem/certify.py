"""A model's answer beside the full-order model's, solved from rest."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.model import FingerModel
from fingerfem.scene.grid_lines import section_mesh
from fingerfem.scene.scene import Scene
from fingerfem.scene.sections.circle import Round
from rom.answer import Answer
from rom.rod import rod
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel

NEAREST = 1e-4  # of a plane before a finger of elements, whose file has no nearest distance [m]


@dataclass(frozen=True, kw_only=True)
class Certificate:
    """Comparison of a model's answer at one point with the full-order model on its mesh.

    Attributes:
        answer: the model's.
        tip: displacement of the tip plate's centre by the full-order model, shape (3,) [m].
        contact_force: likewise [N]; None without a plane.
        factorisations: that the full-order model needed.
        corners: distance of the mesh's corners outside a round section, by which contact begins too early [m].
    """

    answer: Answer
    tip: np.ndarray
    contact_force: float | None
    factorisations: int
    corners: float = 0.0

    @property
    def errors(self) -> dict[str, float]:
        """True errors of tip [m] and contact force [N]."""
        errors = {"tip": float(np.linalg.norm(self.answer.tip - self.tip))}
        if self.contact_force is not None:
            errors["contact_force"] = abs(float(self.answer.contact_force) - self.contact_force)
        return errors

    @property
    def covered(self) -> bool:
        """True if the model's own estimates cover the errors, and the point is inside its domain."""
        estimated = self.answer.error
        return bool(self.answer.inside) and all(error <= estimated[name] for name, error in self.errors.items())

    @property
    def marks(self) -> list[str]:
        """Sentences with the reasons not to rely on the full-order values."""
        outside = (
            f"the full-order mesh has corners {1e3 * self.corners:.2g} mm outside the circle, where contact begins"
        )
        return [f"{outside}: train with mesh.order = 2 for a nearer comparison"] * (self.corners > 0)

    def as_json(self) -> dict[str, Any]:
        """Plain data: of each quantity the model's answer, full-order value, error, estimated error, in [m] and [N]."""
        full_order = {"tip": self.tip.tolist(), "contact_force": self.contact_force}
        quantities = {
            name: {
                "answer": np.asarray(getattr(self.answer, name)).tolist(),
                "full_order": full_order[name],
                "error": error,
                "estimated_error": float(self.answer.error[name]),
            }
            for name, error in self.errors.items()
        }
        return quantities | {
            "inside": bool(self.answer.inside),
            "covered": self.covered,
            "factorisations": self.factorisations,
        }


class Certifier:
    """Solves with the full-order model what a model answers.

    Args:
        model: a table of full-order states; or a finger of elements before the plane y = side/2 + d.

    Raises:
        ValueError: a table of a finger of elements, whose scene has no plane.
    """

    def __init__(self, model: SeparatedModel | TouchedSegment):
        if isinstance(model, SeparatedModel) and "specialised_from" in model.provenance:
            raise ValueError("model must be the finger itself to be certified, got a table of one")
        self.model, self.full_order = model, FingerModel(Scene.model_validate(full_order_scene(model)))

    def certify(self, tensions: ArrayLike, distance: float | None = None) -> Certificate:
        """Both answers at tensions [N], shape (t,), and the plane's distance [m]; None leaves it away.

        Raises:
            ValueError: a tension or distance that the scene does not allow.
            LoadNotReached: the full-order model has no answer.
        """
        full_order, pulled = self.full_order, np.asarray(tensions, float)
        newton, before = full_order.continuation.newton, full_order.continuation.newton.factorisations
        state = full_order.solve(pulled, distance, sensitivities=False)
        return Certificate(
            answer=self.model.evaluate(_point(self.model, pulled, distance)),
            tip=state.tip,
            contact_force=None if distance is None else state.contact_force,
            factorisations=newton.factorisations - before,
            corners=0.0 if distance is None else corners_outside(full_order.scene),
        )


def corners_outside(scene: Scene) -> float:
    """Distance by which a mesh's corners are outside the circle of its section [m]; 0 without one, or at order 2."""
    shape = scene.geometry.shape
    if not isinstance(shape, Round) or scene.mesh.order > 1:
        return 0.0
    points = section_mesh(scene.outline, scene.mesh.cells[1]).points
    return float(np.linalg.norm(points, axis=1).max()) - shape.diameter / 2


def full_order_scene(model: SeparatedModel | TouchedSegment) -> dict[str, Any]:
    """The scene that the full-order model solves, as plain data: of a finger of elements, before the plane.

    Its cells are as large against the section as those of the training, or of the finer mesh whose states have
    corrected the elements.
    """
    if isinstance(model, SeparatedModel):
        return model.scene
    nearest, farthest = model.obstacle.distances
    plane = {"distance": [max(nearest, NEAREST), farthest], "method": "penalty"}
    return {key: value for key, value in model.scene.items() if key != "load"} | {
        "obstacle": plane,
        "mesh": _mesh(model.rod),
    }


def _mesh(finger: rod.Rod) -> dict[str, Any]:
    """The mesh of a finger of elements: cells along its longest segment as long as those of the elements' mesh."""
    trained, provenance = finger.elements.scene, finger.elements.provenance
    own = provenance.get("corrected_by", trained["mesh"])
    along, across = own["cells"]
    length = max(finger.scene["geometry"]["segments"]) / finger.similarity.size
    return trained["mesh"] | {
        "order": own["order"],
        "cells": [max(round(along * length / trained["geometry"]["segments"][0]), 1), across],
    }


def _point(model: SeparatedModel | TouchedSegment, pulled: np.ndarray, distance: float | None) -> np.ndarray:
    return np.append(pulled, [np.inf if distance is None else distance] if model.has_obstacle else [])
