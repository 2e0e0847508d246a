"""Extremes of what is separated: tensors of every kind and size, few nodes, many terms, values that are no numbers."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rom.separated.alternating_directions import EnrichmentOptions, compose, separate
from rom.separated.form import Separated
from studies.extremes.verdicts import Row, judged

PART = "separated form"


def rows() -> Iterator[Row]:
    """All of them; the reference is the tensor itself."""
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

        yield judged(PART, "response", name, "the error it states, against the true one", 1e-9, error)
    for terms in (10, 1000):

        def beyond(terms: int = terms) -> float:
            data = np.random.default_rng(2).standard_normal((1, 4, 4, 4))
            factors, errors = separate(data, EnrichmentOptions(tolerance=1e-15, terms=terms))
            largest = max(float(np.abs(factor).max()) for factor in factors)
            if largest > 1e3 * np.abs(data).max():
                return np.inf
            return abs(float(np.linalg.norm(compose(factors) - data) / np.linalg.norm(data)) - float(errors[-1]))

        yield judged(PART, "rank", f"{terms} terms of data of rank 16 at most", "the error it states", 1e-9, beyond)

    def two_nodes() -> float:
        data = np.random.default_rng(3).standard_normal((1, 2, 2))
        factors, errors = separate(data, EnrichmentOptions(tolerance=1e-12))
        functions = [np.array([factor, np.repeat(np.diff(factor, axis=0), 2, axis=0)]) for factor in factors[1:]]
        ends = np.array([[0.0, 0.0], [1.0, 1.0]])
        form = Separated(ends=ends, functions=functions, modes=factors[0], errors=errors)
        corners = [float(form.value_and_gradient([i, j])[0][0]) - data[0, i, j] for i in (0, 1) for j in (0, 1)]
        return float(np.abs(corners).max())

    yield judged(PART, "nodes", "two an axis", "the data at their corners", 1e-9, two_nodes)
    for value in (np.nan, np.inf):

        def broken(value: float = value) -> float:
            data = np.ones((2, 3, 3))
            data[0, 1, 1] = value
            return float(separate(data, EnrichmentOptions())[1][-1])

        yield judged(PART, "response", f"a value that is {value}", "", 0.0, broken)
