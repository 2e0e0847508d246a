"""A snapshot set -> a model: pressed states -> a finger of rod elements, states on a grid -> a separated model.

Held-out states on a finer mesh measure the error of the training's mesh.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rom.console.terminal import Progress, quiet
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet
from rom.elements.fitting import training
from rom.elements.fitting.calibration import conformal
from rom.elements.samples.section_states import read_section_states
from rom.files.file_kinds import uses_of
from rom.plane_check import Model, accuracy, before_plane, check, check_finer, differences
from rom.rod.rod import QUANTITIES, Rod
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.errors import estimated
from rom.separated.grid_source import grid_samples
from rom.separated.model import SeparatedModel
from rom.separated.tabulated import tabulated
from rom.summaries import finer_origin, origin

FEWEST = 3  # states on a finer mesh that touch


def train_rod(
    snapshots: SnapshotSet,
    provenance: dict[str, Any],
    finer: Sequence[SnapshotSet],
    progress: Progress = quiet,
    highest: float = training.HIGHEST,
) -> Rod:
    """Build the finger of a set of pressed states.

    Args:
        snapshots: the set.
        provenance: what it is.
        finer: states on a finer mesh: pressed ones correct its elements, those before the plane enlarge estimates.
        progress: called with the step, how much of it is done, and how much it is.
        highest: weighted degree of the elements' polynomials [-].

    Raises:
        SnapshotError: a held-out set, too few lines, or sets of another finger, or on no finer mesh.
        ValueError: two finer sets of pressed states.
    """
    if snapshots.description.random:
        raise SnapshotError(f"{snapshots.path}: must be a training set{uses_of(snapshots.path)}")
    for one in finer:
        check_finer(snapshots.description.scene, one)
    pressed = [one for one in finer if one.description.has_load]
    before_plane = [one for one in finer if not one.description.has_load]
    if len(pressed) > 1:
        raise ValueError(f"finer must be one set of pressed states at most, got {len(pressed)}")
    sections = read_section_states(snapshots)
    corrects = read_section_states(pressed[0], sections.at) if pressed else None
    provenance = provenance | ({"corrected_by": finer_origin(pressed[0])} if pressed else {})
    finger = Rod(elements=training.train(sections, provenance, progress, corrects, highest), scene=sections.scene)
    return with_mesh_error(finger, before_plane) if before_plane else finger


def with_mesh_error(rod: Rod, finer: Sequence[SnapshotSet]) -> Rod:
    """A finger of elements whose estimated errors are enlarged, where need be, to what held-out states show.

    They are of a finer mesh, before the plane y = side/2 + d.

    Raises:
        SnapshotError: not such states of the finger on a finer mesh, or too few that touch.
    """
    for one in finer:
        check_finer(rod.scene, one)
    covered = covering([(before_plane(rod, one), one) for one in finer])
    if "contact_force" not in covered:
        raise SnapshotError(f"{finer[0].path}: must have {FEWEST} states that touch, to estimate the error of forces")
    factors = {name: rod.elements.error_factor(name) * covered[name] for name in QUANTITIES}
    provenance = rod.elements.provenance | {"mesh_error": [finer_origin(one) for one in finer]}
    return replace(rod, elements=replace(rod.elements, provenance=provenance, error_factors=factors))


def covering(pairs: Sequence[tuple[Model, SnapshotSet]]) -> dict[str, float]:
    """Factors by which estimated errors of models cover held-out states, by quantity, at least 1 [-].

    The least factor is the conformal quantile, see `rom.elements.fitting.calibration`, for states drawn like these.
    """
    ratios: dict[str, list[np.ndarray]] = {}
    for model, states in pairs:
        answers, off = model.evaluate(states.random("parameters")), differences(model, states)
        touched = answers.inside & (answers.contact_force > 0) & (states.random("contact_force") > 0)
        for name in answers.error.keys() & off.keys():
            own = touched if name in ("contact_force", "pad_pressure") else answers.inside
            ratios.setdefault(name, []).append(off[name][own] / answers.error[name][own])
    together = {name: np.concatenate(parts) for name, parts in ratios.items()}
    return {name: max(conformal(parts), 1.0) for name, parts in together.items() if len(parts) >= FEWEST}


def separate_grid(
    snapshots: SnapshotSet,
    options: EnrichmentOptions | None = None,
    *,
    held_out: SnapshotSet | None = None,
    finer: SnapshotSet | None = None,
    progress: Progress = quiet,
) -> SeparatedModel:
    """Build the separated model of states on a grid, as the paper makes it.

    Its estimated errors are those of the model of every second node, at all states.

    Args:
        snapshots: a training set on a grid.
        options: of the separations.
        held_out: states before the same plane, which measure its accuracy.
        finer: held-out states on a finer mesh, which enlarge its estimated errors.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        SnapshotError: a set without such a grid; or finer states of another finger, or on no finer mesh.
    """
    samples = [grid_samples(snapshots, every) for every in (1, 2)]
    if finer is not None:
        check_finer(snapshots.description.scene, finer)
    table, half = (tabulated(one, options or EnrichmentOptions(), progress) for one in samples)
    failed = np.array([point for _, point, _ in snapshots.failures]).reshape(-1, len(table.parameters))
    failed = np.where(np.isnan(failed), table.limits[0], failed)  # without a touch distance
    points, off = snapshots.points(), differences(half, snapshots, progress)
    off = {name: np.append(errors, np.zeros(len(failed))) for name, errors in off.items()}
    cells = min(len(axis) for axis in samples[0].axes) - 1
    valid = np.arange(len(points) + len(failed)) < len(points)
    errors = estimated(half, np.vstack([points, failed]), off, valid, cells)
    table = replace(table, errors=errors, provenance=table.provenance | origin(snapshots))
    if finer is not None:
        provenance = table.provenance | {"mesh_error": finer_origin(finer)}
        table = replace(table, errors=errors.scaled(covering([(table, finer)])), provenance=provenance)
    return table if held_out is None else replace(table, accuracy=accuracy(check(table, held_out, progress)))
