"""Extremes of what a surrogate is made from: snapshots that repeat or all but repeat, responses no product follows."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from rom.build import train
from rom.elements.polynomial import Samples, fit
from rom.held_out import FELT
from rom.separated.alternating_directions import EnrichmentOptions, compose, separate
from rom.separated.separated_form import Separated
from rom.snapshots.folder import create
from rom.snapshots.schema import FIELDS
from rom.snapshots.snapshot_set import SnapshotSet, read_task, write_task
from studies import sets
from studies.extremes.verdicts import Row, judged

PART = "surrogate"
OPTIONS = EnrichmentOptions()
Change = Callable[[str, np.ndarray], np.ndarray]


def rewritten(of: SnapshotSet, name: str, *changes: Change, fields: bool = False) -> SnapshotSet:
    """A set of scattered lines beside another, with all its lines once for every change of their numbers."""
    place = of.path.parent / name
    shutil.rmtree(place, ignore_errors=True)
    description = of.description if fields else sets.without_store(of.description)
    left = ("task", "fingerprint", *(() if fields else FIELDS))
    create(place, replace(description, scattered=list(description.scattered) * len(changes)))
    shutil.copy(of.path / "body.npz", place)
    count = len(description.scattered)
    for k, change in enumerate(changes):
        for line in range(count):
            stored = read_task(of.path, f"scattered-{line}", without=left)
            new = {key: change(key, values) if values.dtype.kind == "f" else values for key, values in stored.items()}
            write_task(place, f"scattered-{k * count + line}", description.fingerprint, new)
    return SnapshotSet(place)


def rows(folder: Path) -> Iterator[Row]:
    """All of them; the snapshots are solved in `folder` if they are not there."""
    yield from snapshots(folder)
    yield from tensors()
    yield from functions()


def snapshots(folder: Path) -> Iterator[Row]:
    """The same states twice, nearly twice, in single precision, and too few."""
    scene = sets.scene(folder, "draft")
    whole, held_out = sets.training(scene), sets.held_out(scene, sets.QUICK_HELD_OUT)
    points, true = held_out.random("parameters"), held_out.random("contact_force")
    felt = true > FELT
    usual = train(rewritten(whole, "as it is", as_it_is), OPTIONS).evaluate(points).contact_force
    noise = np.random.default_rng(0)

    def far(name: str, *changes: Change) -> Callable[[], float]:
        def error() -> float:
            found = train(rewritten(whole, name, *changes), OPTIONS).evaluate(points).contact_force
            return float(np.percentile(np.abs(found - usual)[felt] / true[felt], 95))

        return error

    def nearly(name: str, values: np.ndarray) -> np.ndarray:
        return values if name == "regime" else values * (1 + 1e-12 * noise.standard_normal(values.shape))

    def apart(name: str, values: np.ndarray) -> np.ndarray:
        return values if name == "regime" else values * (1 + 1e-7 * noise.standard_normal(values.shape))

    def in_single_fields() -> float:
        usual, found = (train(one, OPTIONS) for one in (whole, rewritten(whole, "fields", single, fields=True)))
        off = [np.abs(found.displacement(point) - usual.displacement(point)).max() for point in points]
        return float(np.percentile(off, 95) / np.percentile(np.abs(held_out.random("displacement")), 99))

    def first(name: str, values: np.ndarray) -> np.ndarray:
        return np.repeat(values[:1], len(values), axis=0) if values.ndim else values

    what = "the same set as it is, contact force"
    yield judged(PART, "snapshots", "every state twice", what, 1e-6, far("twice", as_it_is, as_it_is))
    yield judged(PART, "snapshots", "every state twice, 1e-12 apart", what, 1e-6, far("nearly", as_it_is, nearly))
    yield judged(PART, "snapshots", "every state twice, 1e-7 apart", what, 5e-2, far("apart", as_it_is, apart))
    yield judged(PART, "snapshots", "in single precision", what, 1e-2, far("single", single))
    what = "the same set as it is, displacement"
    yield judged(PART, "snapshots", "in single precision, fields too", what, 1e-2, in_single_fields)
    yield judged(PART, "snapshots", "no state in contact", "", 0.0, far("first", first))


def as_it_is(name: str, values: np.ndarray) -> np.ndarray:
    """No change."""
    return values


def single(name: str, values: np.ndarray) -> np.ndarray:
    """To single precision."""
    return values.astype(np.float32).astype(float)


def tensors() -> Iterator[Row]:
    """Tensors of every kind to be separated; the reference is the tensor itself."""
    x, y, z = np.meshgrid(*[np.linspace(0, 1, 12)] * 3, indexing="ij")
    cases = {
        "zero": np.zeros((1, 12, 12, 12)),
        "constant": np.full((1, 12, 12, 12), 3.7),
        "linear": (1 + x + 2 * y - z)[None],
        "a jump across the diagonal": (x + y > z + 0.5).astype(float)[None],
        "1e150 in size": 1e150 * np.sin(x * y + z)[None],
        "1e-150 in size": 1e-150 * np.sin(x * y + z)[None],
        "noise": np.random.default_rng(1).standard_normal((1, 12, 12, 12)),
    }
    for name, tensor in cases.items():

        def error(tensor: np.ndarray = tensor) -> float:
            factors, errors = separate(tensor, EnrichmentOptions(tolerance=1e-10, terms=40))
            size = np.abs(tensor).max() or 1.0
            left = np.linalg.norm((compose(factors) - tensor) / size) / (np.linalg.norm(tensor / size) or 1.0)
            return abs(float(left) - float(errors[-1]))

        yield judged(PART, "response", name, "the error it says, against the true one", 1e-9, error)
    for terms in (10, 1000):

        def beyond(terms: int = terms) -> float:
            data = np.random.default_rng(2).standard_normal((1, 4, 4, 4))
            factors, errors = separate(data, EnrichmentOptions(tolerance=1e-15, terms=terms))
            largest = max(float(np.abs(factor).max()) for factor in factors)
            if largest > 1e3 * np.abs(data).max():
                return np.inf
            return abs(float(np.linalg.norm(compose(factors) - data) / np.linalg.norm(data)) - float(errors[-1]))

        yield judged(PART, "rank", f"{terms} terms of data of rank 16 at most", "the error it says", 1e-9, beyond)

    def two_nodes() -> float:
        data = np.random.default_rng(3).standard_normal((1, 2, 2))
        factors, errors = separate(data, EnrichmentOptions(tolerance=1e-12))
        form = Separated(
            lower=np.zeros(2), upper=np.ones(2), factors=factors[1:],
            slopes=[np.repeat(np.diff(factor, axis=0), 2, axis=0) for factor in factors[1:]],
            modes=factors[0], errors=errors, lost=np.zeros((len(errors), 1)),
        )  # fmt: skip
        corners = [float(form.value([i, j])[0]) - data[0, i, j] for i in (0, 1) for j in (0, 1)]
        return float(np.abs(corners).max())

    yield judged(PART, "nodes", "two an axis", "the data at their corners", 1e-9, two_nodes)
    for value in (np.nan, np.inf):

        def broken(value: float = value) -> float:
            data = np.ones((2, 3, 3))
            data[0, 1, 1] = value
            return float(separate(data, OPTIONS)[1][-1])

        yield judged(PART, "response", f"a value that is {value}", "", 0.0, broken)


def functions() -> Iterator[Row]:
    """What the fit says of its own error, for functions it cannot follow."""
    random = np.random.default_rng(4)
    points, others = random.uniform(-1, 1, (300, 2)), random.uniform(-1, 1, (2000, 2))
    cases: dict[str, Callable[[np.ndarray], np.ndarray]] = {
        "constant": lambda x: np.full(len(x), 2.0),
        "linear": lambda x: 1 + x[:, 0] - 3 * x[:, 1],
        "a kink": lambda x: np.abs(x[:, 0] + 0.3 * x[:, 1]),
        "a jump": lambda x: np.where(x[:, 0] > 0.2, 1.0, -1.0),
    }
    for name, function in cases.items():

        def said(function: Callable[[np.ndarray], np.ndarray] = function) -> float:
            found = fit(
                Samples(
                    points=points, values=function(points)[:, None], slopes=None, weights=np.ones(len(points)),
                    lower=np.full(2, -1.0), upper=np.ones(2),
                )
            )  # fmt: skip
            true = np.percentile(np.abs(found.polynomial.value(others)[:, 0] - function(others)), 95)
            told = np.percentile(np.abs(found.residuals), 95)
            return float(max(true - told, 0.0) / max(told, 1e-9))

        yield judged(PART, "function to fit", name, "true error beyond that of states left out", 1.0, said)
