"""Position of an object from several touches of it: bounded least squares for their measurements."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from rom.brief import brief
from rom.rod.compiled.evaluation import evaluate
from rom.rod.touched_segment import TouchedSegment

FORCE, TOUCH = 3, 4  # rows of an answer
STEP = 1e-3  # by which places are scaled in the search [m]
CLOSE = 3.0  # of its standard deviation: a residual that counts as met [-]
MOST = 200  # evaluations from one start
STARTS = np.array(
    [[0, 0, 0], *(np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 3)]
)  # of within
LEAST = 1e-6  # standard deviation of a felt force that is at least counted with [N]


@brief
@dataclass(frozen=True, kw_only=True)
class FoundObject:
    """An object's place.

    Attributes:
        centre: of the object at d = 0, shape (3,) [m].
        covariance: of it, by the sensor's noise and the model's error, shape (3, 3) [m^2]; infinite where touches leave
            it open.
        others: places that explain the touches too, shape (k, 3) [m].
        status: converged; undetermined, where there are others, or a direction is open as wide as was searched; or
            unreachable, where no place was found that explains the touches; or out_of_domain, where the model does not
            have an answer at a touch of what is there (not trained, or not stable).
        residual: largest difference from a felt force [N].
        iterations: evaluations of all touches.
    """

    centre: np.ndarray
    covariance: np.ndarray
    others: np.ndarray
    status: str
    residual: float
    iterations: int

    @property
    def deviations(self) -> np.ndarray:
        """Standard deviations along x, y, z, shape (3,) [m]."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def converged(self) -> bool:
        """True if the position is determined."""
        return self.status == "converged"

    def as_json(self) -> dict[str, Any]:
        """Plain numbers."""
        return {
            "centre": self.centre.tolist(),
            "others": self.others.tolist(),
            "deviations": self.deviations.tolist(),
            "status": self.status,
            "residual": self.residual,
            "iterations": self.iterations,
        }


def find_object(
    model: TouchedSegment,
    tensions: ArrayLike,
    contact_forces: ArrayLike,
    distances: ArrayLike = 0.0,
    *,
    noise: float = 0.0,
    within: float = 0.01,
) -> FoundObject:
    """Find where the model's object is, of which the shape and how it is turned are known.

    Args:
        model: the finger, with the object where it may be.
        tensions: of m touches, shape (m, t) [N].
        contact_forces: felt along the object's direction, shape (m,), above 0 [N].
        distances: d of the object at each touch, shape (m,) or one for all [m].
        noise: standard deviation of the force sensor [N].
        within: how far the object may be from where the model has it, along each axis [m].

    Raises:
        ValueError: shapes that do not fit, fewer than three touches, or forces that are not above 0.

    Example:
        >>> found = find_object(model, [[20, 0], [25, 5], [25, 15]], [0.31, 0.52, 0.44])
        >>> found.centre, found.deviations
    """
    pulled, felt = np.atleast_2d(np.asarray(tensions, float)), np.asarray(contact_forces, float)
    if pulled.shape != (felt.size, len(model.names) - 1) or felt.ndim != 1 or felt.size < 3:
        raise ValueError(
            f"tensions must be of three touches at least, shape (m, {len(model.names) - 1}), and as many forces"
        )
    if not (np.isfinite(pulled).all() and ((felt > 0) & (felt < np.inf)).all() and noise >= 0 and within > 0):
        raise ValueError("tensions must be finite, contact forces and within above 0, noise at least 0")
    points = np.column_stack([pulled, np.broadcast_to(np.asarray(distances, float), felt.shape)])
    if not np.isfinite(points).all():
        raise ValueError(f"distances must be finite, got {distances!r}")
    guess = np.asarray(model.obstacle.centre, float)

    def moved(way: np.ndarray) -> TouchedSegment:
        return replace(model, obstacle=replace(model.obstacle, centre=tuple(guess + STEP * way)))

    def answers(way: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residuals, their derivatives by the way, and estimated errors of the forces."""
        there = moved(way)
        answer = there.answers(points, by_object=True)
        assert answer.by_object is not None
        force, touch = answer.out[:, FORCE], answer.out[:, TOUCH]
        pressed = force > 0
        slopes = -answer.jacobians[:, FORCE, -1]
        stiffness = float(np.median(slopes[pressed])) if pressed.any() else float(felt.max() / within)
        near = ~pressed & np.isfinite(touch)  # an object not touched yet attracts by its gap
        off = np.where(pressed, force, 0.0)
        off[near] = stiffness * np.minimum(touch - points[:, -1], 0.0)[near]
        by_place = np.where(pressed[:, None], answer.by_object[:, FORCE, :3], 0.0)
        by_place[near] = stiffness * answer.by_object[near, TOUCH, :3]
        error = np.where(pressed, evaluate(there.touching, points).errors[:, 1], 0.0)
        return off - felt, STEP * by_place, np.hypot(np.maximum(noise, LEAST), np.minimum(error, felt.max()))

    ends = np.full(3, within / STEP)
    scale = 1 / np.maximum(noise, LEAST + 1e-3 * felt)
    tries = [
        least_squares(
            lambda way: answers(way)[0] * scale,
            share * ends,
            jac=lambda way: answers(way)[1] * scale[:, None],
            bounds=(-ends, ends),
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
            max_nfev=MOST,
        )
        for share in STARTS  # an edge that the object may lie on either side of makes valleys of its own
    ]
    valleys = [(solved.x, *answers(solved.x)) for solved in sorted(tries, key=lambda one: one.cost)]
    place, off, by_place, deviations = valleys[0]
    weighted = by_place / (STEP * deviations[:, None])
    sizes, axes = np.linalg.svd(weighted, full_matrices=False)[1:]
    known = bool((sizes * within > 1.0).all())
    covariance = (axes.T / sizes**2) @ axes if known else np.full((3, 3), np.inf)
    explains = [bool(np.all(np.abs(one[1]) <= CLOSE * one[3] + 1e-6 * felt)) for one in valleys]
    apart = 10 * np.sqrt(np.trace(covariance)) if known else np.inf
    others = [guess + STEP * one[0] for one, well in zip(valleys, explains, strict=True) if well]
    others = [one for one in others if np.linalg.norm(one - guess - STEP * place) > apart]
    if not explains[0]:
        status = "unreachable"
    elif not moved(place).answers(points).inside.all():
        status = "out_of_domain"
    else:
        status = "converged" if known and not others else "undetermined"
    return FoundObject(
        centre=guess + STEP * place,
        covariance=covariance,
        others=np.array(others).reshape(-1, 3),
        status=status,
        residual=float(np.abs(off).max()),
        iterations=sum(int(one.nfev) for one in tries),
    )
