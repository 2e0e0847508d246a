"""Contact regimes: sets of active contacts. In each, everything depends smoothly on the parameters.

A regime's code lists plate by plate whether it carries (0, 1) and with which end along its own x, y and z (-1, 1, or 0
for what lies between), then segment by segment whether its rubber touches (0, 1). A regime ends where one of its signs
turns: a plate that stands on a corner tilts until its edge lies flat, the centre of pressure on an edge comes to its
end, a gap closes, a force vanishes. Each of these is a smooth function inside the regime, known from its states.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Code = tuple[int, ...]
Corner = tuple[int, Code]  # segment and ends of a plate's corner
QUANTITIES = ("plate_height", "plate_tilt", "plate_force", "centre_of_pressure", "rubber_reach")


@dataclass(frozen=True, kw_only=True)
class Sign:
    """A condition of a regime: it holds while its value is positive, and where it fails another regime follows.

    Attributes:
        kind: tilt, centre, force, gap, rubber_force or rubber_gap.
        segment: whose plate or rubber, from 0.
        axis: of the plate's own, for tilt and centre.
        end: -1 or 1, for tilt and centre.
        target: index of the regime that follows; -1 if none is known.
    """

    kind: str
    segment: int
    axis: int = 0
    end: int = 0
    target: int = -1


def segments(code: Code) -> int:
    """Number of segments a code speaks of."""
    return len(code) // 5


def plate(code: Code, segment: int) -> tuple[int, Code]:
    """Whether a plate carries, and at which ends along x, y, z."""
    return code[4 * segment], code[4 * segment + 1 : 4 * segment + 4]


def rubber(code: Code, segment: int) -> int:
    """Whether the rubber of a segment touches."""
    return code[4 * segments(code) + segment]


def describe(code: Code) -> str:
    """A regime in words, such as "contact by plate 1's corner (+x, +y, -z) and segment 1's rubber".

    A corner has an end along each of the plate's own axes, an edge along two, a face along one; x points to the tip,
    y to the plane.
    """
    found = []
    for k in range(segments(code)):
        carries, ends = plate(code, k)
        if carries:
            signs = ", ".join(f"{'+' if end > 0 else '-'}{axis}" for end, axis in zip(ends, "xyz", strict=True) if end)
            part = ("middle", "face", "edge", "corner")[sum(end != 0 for end in ends)]
            found.append(f"plate {k + 1}'s {part}" + (f" ({signs})" if signs else ""))
    found += [f"segment {k + 1}'s rubber" for k in range(segments(code)) if rubber(code, k)]
    return "contact by " + " and ".join(found) if found else "no contact"


def corner(code: Code, half: bool) -> Corner | None:
    """Segment and ends of the corner that alone carries; None if it is not a corner, or not alone.

    Of half a finger a corner is an edge across: it has no end along z.
    """
    carrying = [k for k in range(segments(code)) if plate(code, k)[0]]
    if len(carrying) != 1 or any(code[4 * segments(code) :]):
        return None
    ends = plate(code, carrying[0])[1]
    return (carrying[0], ends) if all(ends[: 2 if half else 3]) else None


def nearest_corner(code: Code, corners: Counter[Corner]) -> Corner:
    """The corner to measure the contact path from where none is active alone: one in common, of most states."""
    carrying = {k: plate(code, k)[1] for k in range(segments(code)) if plate(code, k)[0]}

    def shared(corner: Corner) -> int:
        ends = carrying.get(corner[0])
        return 0 if ends is None else 1 + all(end in (0, own) for end, own in zip(ends, corner[1], strict=True))

    if corners:
        return max(corners, key=lambda corner: (shared(corner), corners[corner]))
    return segments(code) - 1, (1, 1, -1)


def signs(codes: Sequence[Code], counts: Counter[Code]) -> list[list[Sign]]:
    """The conditions of every regime, of those whose failing leads to another regime that is known."""
    return [_signs(code, list(codes), counts) for code in codes]


def _signs(code: Code, codes: list[Code], counts: Counter[Code]) -> list[Sign]:
    found = []
    for k in range(segments(code)):
        carries, ends = plate(code, k)
        if not carries:
            found.append(Sign(kind="gap", segment=k, target=_carrying(code, k, codes, counts)))
        else:
            lifted = _replaced(code, 4 * k, (0, 0, 0, 0))
            found.append(Sign(kind="force", segment=k, target=_index(lifted, codes)))
            for a, end in enumerate(ends):
                at = 4 * k + 1 + a
                if end:
                    target = _index(_replaced(code, at, (0,)), codes)
                    found.append(Sign(kind="tilt", segment=k, axis=a, end=end, target=target))
                else:
                    found += [
                        Sign(
                            kind="centre",
                            segment=k,
                            axis=a,
                            end=other,
                            target=_index(_replaced(code, at, (other,)), codes),
                        )
                        for other in (-1, 1)
                    ]
        at = 4 * segments(code) + k
        touches = rubber(code, k)
        target = _index(_replaced(code, at, (1 - touches,)), codes)
        found.append(Sign(kind="rubber_force" if touches else "rubber_gap", segment=k, target=target))
    return [sign for sign in found if sign.target >= 0]


def _replaced(code: Code, at: int, by: Code) -> Code:
    return code[:at] + by + code[at + len(by) :]


def _index(code: Code, codes: list[Code]) -> int:
    return codes.index(code) if code in codes else -1


def _carrying(code: Code, segment: int, codes: list[Code], counts: Counter[Code]) -> int:
    """Of the regimes in which this plate carries too, the one with the most states."""
    at = 4 * segment
    same = [other for other in codes if other[at] == 1 and other[:at] + other[at + 4 :] == code[:at] + code[at + 4 :]]
    return codes.index(max(same, key=lambda other: counts[other])) if same else -1


def sign_values(sign: Sign, states: dict[str, np.ndarray], half_lengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values of a condition at states, shape (n,), and their derivatives by the parameters, shape (n, p).

    Args:
        sign: the condition.
        states: the quantities of rom.snapshots that it needs, by name, with their jacobians.
        half_lengths: of a plate along its own axes, shape (3,) [m].
    """
    k = sign.segment

    def of(name: str) -> tuple[np.ndarray, np.ndarray]:
        return states[name][:, k], states[f"{name}_jacobian"][:, k]

    if sign.kind == "tilt":
        value, slope = of("plate_tilt")
        return sign.end * value[:, sign.axis], sign.end * slope[:, sign.axis]
    if sign.kind == "centre":
        # What the other end carries, twice: the centre itself is no smooth function where the force vanishes.
        value, slope = of("centre_of_pressure")
        force, force_jacobian = of("plate_force")
        share = 1 - sign.end * value[:, sign.axis]
        return share * force, share[:, None] * force_jacobian - sign.end * force[:, None] * slope[:, sign.axis]
    if sign.kind == "force":
        return of("plate_force")
    if sign.kind == "rubber_force":
        carried, slope = states["plate_force"].sum(axis=1), states["plate_force_jacobian"].sum(axis=1)
        return states["contact_force"] - carried, states["contact_force_jacobian"] - slope
    height, height_jacobian = of("rubber_reach" if sign.kind == "rubber_gap" else "plate_height")
    if sign.kind == "gap":
        tilt, tilt_jacobian = of("plate_tilt")
        height = height + np.abs(tilt) @ half_lengths
        height_jacobian = height_jacobian + np.einsum("na,nap,a->np", np.sign(tilt), tilt_jacobian, half_lengths)
    distance_jacobian = np.zeros(height_jacobian.shape[1])
    distance_jacobian[-1] = 1.0
    return states["parameters"][:, -1] - height, distance_jacobian - height_jacobian
