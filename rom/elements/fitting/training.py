"""Fits a finger's elements to its section states, with the degrees that predict the assembled finger best.

All element laws, one polynomial map per kind of element, are fitted to the states of all lines (states at the same
tensions). Their degrees are chosen by cross-validation, by errors of the assembled finger in left-out lines: those of
its contact forces and of its free positions. An element's own residual does not show how it affects the finger.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from rom.brief import brief
from rom.console.terminal import Progress, quiet
from rom.dataset.sections.section import extent, outline
from rom.dataset.trainable import check_lines, check_trainable
from rom.elements.elements import Elements
from rom.elements.fitting.calibration import error_factors, floors_of
from rom.elements.fitting.candidates import Candidates, candidates
from rom.elements.fitting.contact_error import relative_force_errors
from rom.elements.fitting.degrees import HIGHEST, best_degrees
from rom.elements.fitting.mesh_correction import DEGREE, RIDGES, correcting, with_ridge
from rom.elements.law import ElementLaw, ElementMap
from rom.elements.march import march
from rom.elements.outline import train_outline
from rom.elements.pieces import Piece, pieces
from rom.elements.rotation_vectors import angles
from rom.elements.samples.cuts import cut, outline_pairs
from rom.elements.samples.element_samples import element_samples
from rom.elements.samples.section_states import SectionStates
from rom.error_statistics import quantiles

FOLDS = 7  # largest number of groups; the lines of a group are left out together
STROKES = "shortening_m", "growth_m3"
SHARE = 0.9  # quantile of the predicted states' errors by which degrees are compared [-]
FORCE, PLACE = (
    1e-3,
    1e-4,
)  # errors that count equally: of a contact force, relative; of a position, over the finger's length [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Training:
    """The regressions of a finger's elements.

    Attributes:
        states: section states of a finger.
        fold: the group that each state is left out with, shape (n,).
        kinds: for every kind of element, the laws from which one is chosen.
    """

    states: SectionStates
    fold: np.ndarray
    kinds: dict[str, Candidates]
    _laws: dict[tuple[str, float, int], ElementMap] = field(default_factory=dict, repr=False)

    @cached_property
    def pieces(self) -> list[Piece]:
        """The finger's own elements, from the plate to the clamp."""
        lengths = {kind: one.lengths for kind, one in self.kinds.items()}
        return pieces(lengths, self.states.length)

    def left_out(self, degrees: dict[str, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The plate's positions, rotations and the tendons' shortenings, predicted by fits to other folds.

        Shapes (n, 3) [m], (n, 3, 3) [-] and (n, t) [m].
        """
        t, n = self.states.tensions, len(self.fold)
        places, turned, shorter = np.zeros((n, 3)), np.zeros((n, 3, 3)), np.zeros((n, t))
        for k in range(self.fold.max() + 1):
            own = self.fold == k
            laws = [self._law(piece, degrees[piece.kind], k) for piece in self.pieces]
            marched = march(laws, self.states.inputs[own, :t], self.states.inputs[own, t:])
            places[own], turned[own] = marched.plate
            shorter[own] = marched.shortenings
        return places, turned, shorter

    def laws(self, degrees: dict[str, float]) -> dict[str, ElementLaw]:
        """The laws of all kinds, with their variants."""
        return {kind: one.with_variants(degrees[kind]) for kind, one in self.kinds.items()}

    def _law(self, piece: Piece, degree: float, without: int) -> ElementMap:
        key = piece.kind, degree, without
        if key not in self._laws:
            self._laws[key] = self.kinds[piece.kind].law(degree, without).of_length(piece.length)
        return self._laws[key]

    def score(self, degrees: dict[str, float]) -> float:
        """Sum of two SHARE-quantiles of left-out errors [-]: contact forces over FORCE, free positions over PLACE."""
        places, turned, _ = self.left_out(degrees)
        force = float(np.nanquantile(relative_force_errors(self.states, places, turned), SHARE))
        free = self.states.forces == 0
        off = np.linalg.norm(places - self.states.plate.places, axis=1)[free]
        place = float(np.quantile(off, SHARE)) if off.size else 0.0
        return force / FORCE + place / (PLACE * self.states.length)


def prepare(states: SectionStates, highest: float = HIGHEST) -> Training:
    """The regressions of a finger's elements, up to a weighted degree.

    Raises:
        SnapshotError: too few lines to leave some out, or a finger whose sections differ along the axis.
    """
    check_trainable(states.scene)
    of_line, fold = fold_of(states)
    kinds = {}
    for kind, pairs in cut(states.at, extent(states.scene)).items():
        samples = [element_samples(states, *pair) for pair in pairs]
        kinds[kind] = candidates(samples, of_line, states.scene, states.mirrors, highest)
    return Training(states=states, fold=fold, kinds=kinds)


def fold_of(states: SectionStates) -> tuple[dict[int, int], np.ndarray]:
    """The fold (a group of lines left out together) of every line, and that of every state, shape (n,).

    Raises:
        SnapshotError: too few lines.
    """
    lines = np.unique(states.lines)
    check_lines(len(lines))
    folds = {int(line): k % min(FOLDS, len(lines)) for k, line in enumerate(lines)}
    return folds, np.array([folds[int(line)] for line in states.lines])


def train(
    states: SectionStates,
    provenance: dict[str, Any],
    progress: Progress = quiet,
    finer: SectionStates | None = None,
    highest: float = HIGHEST,
) -> Elements:
    """Train a finger's elements.

    Args:
        states: section states of the finger.
        provenance: of the states.
        progress: called with the name of the step, the amount done and the total amount.
        finer: states of the same finger on a finer mesh, at the same cross-sections, which correct the elements.
        highest: largest weighted degree that is tried for the elements' polynomials [-].

    Raises:
        SnapshotError: too few lines to leave some out, or a finger whose sections differ along the axis.
    """
    progress("fitting elements", 0, 2)
    training = prepare(states, highest)
    progress("fitting elements", 1, 2)
    degrees = best_degrees(training.score, training.kinds)
    trainings = [(training, degrees)]
    if finer is not None:
        of_corrections = dict.fromkeys(degrees, DEGREE)
        each = corrections(training, degrees, finer)
        trainings.append((min(each, key=lambda one: one.score(of_corrections)), of_corrections))
    training, of_laws = trainings[-1]
    places, turned, shorter = training.left_out(of_laws)
    outlines, fold = outline_pairs(states.at, extent(states.scene)), fold_of(states)[1]
    off = np.linalg.norm(places - training.states.plate.places, axis=1)
    left_out = {
        "contact_force": quantiles(relative_force_errors(training.states, places, turned)),
        "place_m": quantiles(off),
        "free_place_m": quantiles(off[training.states.forces == 0]),
        "turn_rad": quantiles(angles(turned, training.states.plate.rotations)),
    } | stroke_errors(shorter - training.states.shortenings[:, -1], training.states.pressures)
    progress("fitting elements", 2, 2)
    return Elements(
        laws=training.laws(of_laws),
        outlines={kind: train_outline(states, fold, pairs) for kind, pairs in outlines.items()},
        section=outline(states.scene),
        scene=states.scene,
        force=float(states.scene["load"]["force"]),
        provenance=provenance | {"degrees": degrees, "left_out": left_out},
        error_factors=error_factors(trainings, floors_of(left_out)),
    )


def stroke_errors(off: np.ndarray, pressures: int) -> dict[str, Any]:
    """Quantiles of the largest error in a state, of tendons' shortenings [m] and of chambers' growths [m^3].

    Args:
        off: errors of all strokes, shape (n, t) [m, m^3].
        pressures: how many of them are growths, the last ones.
    """
    parts = np.split(np.abs(off), [off.shape[1] - pressures], axis=1)
    return {name: quantiles(part.max(axis=1)) for name, part in zip(STROKES, parts, strict=True) if part.size}


def corrections(training: Training, degrees: dict[str, float], finer: SectionStates) -> list[Training]:
    """The regressions of the mesh corrections of all elements, by RIDGES, see `rom.elements.fitting.mesh_correction`.

    Args:
        training: on the coarser mesh.
        degrees: that were chosen there.
        finer: states of the same finger on a finer mesh, with the cross-sections of the training's mesh.
    """
    of_line, fold = fold_of(finer)
    kinds = {}
    for kind, pairs in cut(finer.at, extent(finer.scene)).items():
        samples = [element_samples(finer, *pair) for pair in pairs]
        kinds[kind] = correcting(training.kinds[kind], degrees[kind], samples, of_line)
    return [
        Training(states=finer, fold=fold, kinds={kind: with_ridge(one, ridge) for kind, one in kinds.items()})
        for ridge in RIDGES
    ]
