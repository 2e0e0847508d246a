"""Fits a finger's elements to its section states, with the degrees that predict the assembled finger best.

All element laws, one polynomial map per kind of element, are fitted to the states of all lines (states at the same
tensions). Their degrees are chosen by cross-validation, by errors of the assembled finger in left-out lines: those of
its contact forces and of its free positions. An element's own residual does not show how it affects the finger.
"""

from typing import Any

import numpy as np

from rom.console.terminal import Progress, quiet
from rom.dataset.sections.section import extent, outline
from rom.elements.elements import Elements
from rom.elements.fitting.calibration import error_factors, floors_of
from rom.elements.fitting.contact_error import relative_force_errors
from rom.elements.fitting.degrees import HIGHEST, best_degrees
from rom.elements.fitting.mesh_correction import DEGREE, RIDGES, correcting, with_ridge
from rom.elements.fitting.prepared import Training, fold_of, prepare
from rom.elements.outline import train_outline
from rom.elements.rotation_vectors import angles
from rom.elements.samples.cuts import cut, outline_pairs
from rom.elements.samples.element_samples import element_samples
from rom.elements.samples.section_states import SectionStates
from rom.error_statistics import quantiles

STROKES = "shortening_m", "growth_m3"


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
        outlines={kind: train_outline(states, fold, pairs, finer) for kind, pairs in outlines.items()},
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
