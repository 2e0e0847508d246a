"""Histories of the motors of a finger with friction of its tendons in their guides."""

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import ArrayLike

from rom.files.checked_file import ModelError
from rom.rod.guides.guided_finger import GuidedFinger, GuideState
from rom.rod.rod import Rod
from rom.rod.touched_rod import TouchedRod


def guide_history(
    model: Rod | TouchedRod,
    points: ArrayLike,
    friction: float | Sequence[float],
    per_length: float = 0.0,
    wound: Collection[str] = (),
    increments: int = 4,
) -> list[GuideState]:
    """States along a history of motors, which begins at rest and joins the points by straight lines.

    Args:
        model: a finger, alone or before objects.
        points: tensions at the motors, or shortenings of wound tendons, then every d, shape (points, t + m) [N, m].
        friction: coefficient of all tendons in their guides, or of each, shape (t,) [-].
        per_length: friction besides [N/m].
        wound: names of the tendons whose motors are driven by position.
        increments: from point to point; each decides once which tendons slip and which stick.

    Raises:
        ModelError: see `GuidedFinger`; or no increment.

    Example:
        >>> guide_history(TouchedSegment.load(), [[60, 0, 0.05], [30, 0, 0.05]], 0.2)[-1].element_tensions
    """
    finger, rows = (
        GuidedFinger(model=model, friction=friction, per_length=per_length),
        np.atleast_2d(np.asarray(points, float)),
    )
    if increments < 1:
        raise ModelError(f"increments must be at least 1, got {increments}")
    if rows.shape[1:] != (len(finger.names),):
        raise ModelError(f"points must be rows of {', '.join(finger.names)}, got shape {rows.shape}")
    begun, states = rows[0].copy(), []
    begun[: len(finger.rod.names)] = [0.0 if one.name in wound else one.lower for one in finger.rod.parameters]
    for row in rows:
        for k in range(1, 1 + increments):
            share = k / increments
            state = finger.advance(row if k == increments else begun + share * (row - begun), wound)
        states.append(state)
        begun = row
    return states
