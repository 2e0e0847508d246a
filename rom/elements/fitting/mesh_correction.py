"""Correction of every element's law for the error of its training mesh, by a few states on a finer mesh.

A mesh is too stiff by some share that hardly depends on the loads. So the difference of two meshes is a polynomial of
low degree in the products of the law, and few states determine it: each gives samples of every element. A ridge draws
it towards none where they do not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rom.elements.fitting.candidates import Candidates, rows_of
from rom.elements.fitting.regression import NormalEquations, chosen
from rom.elements.law import ElementLaw
from rom.elements.samples.element_samples import Samples

DEGREE = 3.0  # weighted degree of a correction [-]
RIDGE = 1e-2  # of the number of rows, on the diagonal of the normal equations: measured, by lines left out [-]


def correcting(own: Candidates, degree: float, samples: Sequence[Samples], fold_of: dict[int, int]) -> Candidates:
    """The law of an element that is its own one and a correction.

    Args:
        own: laws of the coarser mesh.
        degree: that was chosen among these.
        samples: on the finer mesh, of one length each.
        fold_of: of every line of these.
    """
    law = own.law(degree)
    polynomial, weights = law.polynomial, own.weights
    powers = polynomial.powers[chosen(polynomial.powers, weights, DEGREE)]
    folds, values = max(fold_of.values()) + 1, polynomial.coefficients.shape[1]
    equations = NormalEquations(polynomial.lower, polynomial.upper, powers, folds, values)
    for one in samples:
        left = _without(law, one)
        inputs, differences, jacobians = rows_of(left, law.tension_map, law.has_lengths)
        equations.add(inputs, differences, jacobians, np.array([fold_of[line] for line in one.lines.tolist()]))
    equations.add_images(own.images)
    equations.prior[:] = RIDGE * equations.rows.sum()
    return replace(own, equations=equations, highest=DEGREE, corrected=(own, degree))


def _without(law: ElementLaw, samples: Samples) -> Samples:
    """Samples less a law's values: the residual."""
    values, gradient = law.of_length(samples.length).value_and_gradient(samples.inputs)
    return replace(samples, values=samples.values - values, jacobians=samples.jacobians - gradient)
