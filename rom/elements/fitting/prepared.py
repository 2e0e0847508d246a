"""The regressions of a finger's elements, and what they predict of lines that are left out."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from rom.brief import brief
from rom.dataset.sections.section import extent
from rom.dataset.trainable import check_lines, check_trainable
from rom.elements.fitting.candidates import Candidates, candidates
from rom.elements.fitting.contact_error import relative_force_errors
from rom.elements.fitting.degrees import HIGHEST
from rom.elements.law import ElementLaw, ElementMap
from rom.elements.march import march
from rom.elements.pieces import Piece, pieces
from rom.elements.samples.cuts import cut
from rom.elements.samples.element_samples import element_samples
from rom.elements.samples.section_states import SectionStates

FOLDS = 7  # largest number of groups; the lines of a group are left out together
SHARE = 0.9  # quantile of the predicted states' errors by which degrees are compared [-]
FORCE = 1e-3  # relative error of a contact force that counts as much as that of a position by PLACE [-]
PLACE = 1e-4  # over the finger's length [-]


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
