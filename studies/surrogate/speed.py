"""Times of queries on one core: single points from Python, batches, the whole field, one separated form."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from rom.build import train
from rom.native import answer
from rom.native.forms import values_and_gradients
from rom.separated.separated_form import Separated
from rom.snapshots.snapshot_set import SnapshotSet
from rom.surrogate import Surrogate
from studies.measures import call_times, random_points
from studies.runner import Run
from studies.surrogate.accuracy import OPTIONS, draft_sets, sets_of


def queries(model: Surrogate, file: Path, count: int) -> dict:
    """One core, from Python."""
    model.save(file)
    Surrogate.load(file)
    begun = time.perf_counter()
    model = Surrogate.load(file)
    loading = time.perf_counter() - begun
    points = random_points(model, 20_000)
    single = call_times(model.value_and_jacobian, points)
    many = random_points(model, count)
    model.evaluate(many[:10])
    begun = time.perf_counter()
    answer.answers(model.kernel, many)
    batch = (time.perf_counter() - begun) / count
    return {
        "load_seconds": loading,
        "value_and_jacobian": single,
        "batch": {"count": count, "us_each": 1e6 * batch},
        "bytes": file.stat().st_size,
        "terms": model.terms,
    }


def field(standard: SnapshotSet, file: Path, count: int) -> dict:
    """Time of the whole displacement field, on cells of order 2."""
    model = train(standard, OPTIONS)
    model.save(file)
    Surrogate.load(file)
    begun = time.perf_counter()
    model = Surrogate.load(file)
    loading = time.perf_counter() - begun
    assert model.displacements is not None and model.displacements.contact_basis is not None
    points = random_points(model, count)
    touching = points[model.evaluate(points).contact_force > 0]
    return {
        "unknowns": 3 * len(model.nodes),
        "components": model.displacements.free_basis.shape[1] + model.displacements.contact_basis.shape[1],
        "in_contact": call_times(model.displacement, touching),
        "load_seconds": loading,
        "bytes": file.stat().st_size,
    }


def cost() -> dict:
    """Time of one form's value and gradient in compiled code, against terms and axes, everything else alike."""

    def form(axes: int, terms: int) -> Separated:
        random = np.random.default_rng(0)
        return Separated(
            lower=np.zeros(axes),
            upper=np.ones(axes),
            factors=[random.random((21, terms)) for _ in range(axes)],
            slopes=[random.random((21, terms)) for _ in range(axes)],
            modes=random.random((4, terms)),
            errors=np.zeros(terms),
            lost=np.zeros((terms, 4)),
        )

    def each(one: Separated) -> float:
        points, taken = np.random.default_rng(1).random((3000, len(one.lower))), []
        for _ in range(8):
            begun = time.perf_counter()
            values_and_gradients(one.tables, 0, points)
            taken.append((time.perf_counter() - begun) / len(points))
        return 1e6 * min(taken)

    return {
        "terms": [{"terms": n, "us": each(form(3, n))} for n in (25, 50, 100, 200, 400)],
        "axes": [{"axes": n, "us": each(form(n, 200))} for n in (2, 3, 4, 5, 6)],
    }


def measure(run: Run) -> dict:
    """The draft finger's model; the field on a finer mesh is left out of the short form."""
    training, _ = draft_sets(run)
    model = train(training, OPTIONS)
    found = {
        "query": queries(model, run.folder / "draft.h5", 10_000 if run.quick else 1_000_000),
        "cost": cost(),
    }
    if not run.quick:
        found["field"] = field(sets_of(run, "standard")[0], run.folder / "standard.h5", 2000)
    return found
