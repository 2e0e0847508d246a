"""Ratios of estimated errors to the variants' deviation that cover the errors of left-out lines."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from rom.brief import brief
from rom.elements.fitting.contact_error import gap_by_force, relative_force_changes, relative_force_errors
from rom.elements.fitting.prepared import Training
from rom.elements.march import march
from rom.elements.samples.section_states import SectionStates

TYPICAL = 1.5  # times the median of errors: typical, nearly the root of a normal one's mean square [-]
COVERED = 0.97  # of the states that were left out [-]
QUANTITIES = "tip", "contact_force", "touch_distance"
FEWEST = 5  # states of a kind below which they scale nothing


@brief
class Floors(NamedTuple):
    """Lower bounds of estimated errors, whose variants may agree too well: a typical error of left-out lines.

    Attributes:
        place: of the free plate's place, along any direction [m].
        force: of contact forces, relative [-].
    """

    place: float
    force: float


def floors_of(left_out: Mapping[str, Mapping[str, float]]) -> Floors:
    """TYPICAL times the medians of errors that were left out, by quantity: a place's is of three directions."""
    place, force = (left_out[name]["median"] for name in ("free_place_m", "contact_force"))
    return Floors(TYPICAL * place / np.sqrt(3), TYPICAL * force)


def error_factors(trainings: Sequence[tuple[Training, dict[str, float]]], floors: Floors) -> dict[str, float]:
    """The factors by quantity [-]; at least 1 where a finer mesh corrects, whose own error is in no left-out state.

    Args:
        trainings: on every mesh, with the degrees of all kinds.
        floors: of estimated errors.
    """
    parts = [compared(*each, floors) for each in trainings]
    least, factors = 1.0 if len(trainings) > 1 else 0.0, {}
    for name in QUANTITIES:
        errors, deviations = (np.concatenate([part[k][name] for part in parts]) for k in (0, 1))
        factors[name] = covering(errors, deviations)
    return {name: max(factor, least) for name, factor in factors.items() if factor > 0}


def compared(
    training: Training, degrees: dict[str, float], floors: Floors
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Errors of what was left out, and deviations of variants and floors there, by quantity, shapes (k,).

    The errors are of laws without a state's line, the deviations of the laws' own variants, as answers have them: of
    few lines, variants of what is left of them would deviate far more. The tip's place is compared in all states [m];
    contact forces, relatively, in those with a force [-]; the touch distance by the free plate's place along the sides
    [m].
    """
    states, t = training.states, training.states.tensions
    free = states.forces == 0
    places, turned, _ = training.left_out(degrees)
    laws = training.laws(degrees)
    elements = [laws[piece.kind].of_length(piece.length) for piece in training.pieces]
    marched = march(elements, states.inputs[:, :t], states.inputs[:, t:])
    motions = marched.deviations
    moved = np.einsum("nij,njk->nik", marched.plate[1], motions[:, :3])
    off = places - states.plate.places
    errors = {
        "tip": np.linalg.norm(off, axis=1),
        "contact_force": relative_force_errors(states, places, turned)[~free],
        "touch_distance": np.abs(off[free, 1:]).ravel(),
    }
    deviations = {
        "tip": np.hypot(np.linalg.norm(moved, axis=(1, 2)), np.sqrt(3) * floors.place),
        "contact_force": force_deviations(states, motions, floors)[~free],
        "touch_distance": np.hypot(np.linalg.norm(moved[free, 1:], axis=2), floors.place).ravel(),
    }
    return errors, deviations


def force_deviations(states: SectionStates, motions: np.ndarray, floors: Floors) -> np.ndarray:
    """Relative deviations of contact forces, by variants' plate motions, (n, 6, k), and by floors, shape (n,) [-]."""
    changes = np.linalg.norm(relative_force_changes(states, motions), axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        by_place = floors.place / (states.forces * gap_by_force(states))
    return np.asarray(np.sqrt(changes**2 + by_place**2 + floors.force**2))


def covering(errors: np.ndarray, deviations: np.ndarray) -> float:
    """The factor on deviations that covers COVERED of errors like these, shapes (k,); 0 if there are too few."""
    some = np.isfinite(errors) & (deviations > 0)
    return conformal(errors[some] / deviations[some]) if some.sum() >= FEWEST else 0.0


def conformal(ratios: np.ndarray) -> float:
    """The one of k ratios, shape (k,), that covers a further one with COVERED probability: of rank (k + 1) COVERED.

    The largest, if they are fewer than that needs.
    """
    rank = int(np.ceil((len(ratios) + 1) * COVERED))
    return float(np.sort(ratios)[min(rank, len(ratios)) - 1])
