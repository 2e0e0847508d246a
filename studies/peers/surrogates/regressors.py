"""The methods of other packages, each as a Method of learning.py, with what it needs to be at its best.

What a method has to choose, such as the size of a network, it chooses itself: by its likelihood, or by how well it
predicts lines of states that it was not given (cross-validation).
"""

from __future__ import annotations

import pickle
import warnings
from collections.abc import Callable, Iterable
from functools import reduce
from typing import Any

import numpy as np
from ezyrb import GPR, POD, RBF, Database, ReducedOrderModel
from numpy.polynomial.chebyshev import chebvander
from sklearn.gaussian_process import GaussianProcessRegressor, kernels
from sklearn.model_selection import GroupKFold
from sklearn.neural_network import MLPRegressor
from tensorly.regression import CPRegressor

from studies.peers.surrogates.learning import Fitted, Method

SMOOTHNESS = (1.5, 2.5, np.inf)  # of Matérn kernels, the last the squared exponential [-]
LENGTHS, AMPLITUDES = (1e-2, 1e2), (1e-2, 1e6)  # bounds of a kernel's hyperparameters [-]
NOISE = (1e-12, 1e-4)  # bounds of a variance: states are converged, and a fit that calls them noise is none [-]
RESTARTS = 2  # of searches for hyperparameters; EZyRB's default of 20 finds the same [-]
NETWORKS = ((16, 16), (32, 32), (32, 32, 32))  # neurons by layer [-]
DECAY, ITERATIONS = 1e-5, 3000  # of networks: weight of their norm, steps of L-BFGS [-]
# Of CP regression: highest power along an axis, products, weight of its norm [-]; larger ones err no less.
SEPARATED = ((3, 4, 1.0), (4, 8, 0.1), (4, 16, 0.01), (6, 16, 0.01))
SWEEPS, TRIAL_SWEEPS = 300, 100  # of CP regression: most alternating steps, and those of cross-validation [-]
FOLDS = 3  # of cross-validation [-]
SEED = 0


def radial(inputs: np.ndarray, outputs: np.ndarray, lines: np.ndarray) -> Fitted:
    """EZyRB: POD of the outputs, radial basis functions (its default, the thin plate spline)."""
    return _ezyrb(RBF(), inputs, outputs, "thin plate spline")


def ezyrb_gaussian(inputs: np.ndarray, outputs: np.ndarray, lines: np.ndarray) -> Fitted:
    """EZyRB: POD of the outputs, one Gaussian process for all amplitudes, with a kernel better than its default."""
    approximation = GPR(kernel(SMOOTHNESS[0], inputs.shape[1]), optimization_restart=RESTARTS)
    return _ezyrb(
        approximation, inputs, outputs, f"Matérn kernel of smoothness {SMOOTHNESS[0]}, a length for every axis"
    )


def _ezyrb(approximation: Any, inputs: np.ndarray, outputs: np.ndarray, settings: str) -> Fitted:
    """All modes are kept: there are as many as outputs."""
    model = ReducedOrderModel(Database(inputs, outputs), POD("svd", rank=-1), approximation)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of hyperparameters at their bounds
        model.fit()
    return Fitted(model.predict, len(pickle.dumps(model)), settings)


def kernel(smoothness: float, axes: int) -> kernels.Kernel:
    """With a length for every axis, an amplitude, and a little noise."""
    shape = kernels.Matern(np.ones(axes), LENGTHS, nu=smoothness)
    return kernels.ConstantKernel(10.0, AMPLITUDES) * shape + kernels.WhiteKernel(1e-6, NOISE)


def gaussian(inputs: np.ndarray, outputs: np.ndarray, lines: np.ndarray) -> Fitted:
    """scikit-learn: a Gaussian process for every output, the kernel's smoothness and numbers by their likelihood."""
    found = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of hyperparameters at their bounds
        for output in outputs.T:
            tried = [
                GaussianProcessRegressor(
                    kernel(smoothness, inputs.shape[1]), n_restarts_optimizer=RESTARTS, random_state=SEED
                ).fit(inputs, output)
                for smoothness in SMOOTHNESS
            ]
            found.append(max(tried, key=lambda one: one.log_marginal_likelihood_value_))
    smoothness = sorted({one.kernel_.k1.k2.nu for one in found})
    return Fitted(
        lambda places: np.column_stack([one.predict(places) for one in found]),
        len(pickle.dumps(found)),
        f"Matérn kernels of smoothness {' and '.join(f'{nu:g}' for nu in smoothness)}, a length for every axis",
    )


def network(inputs: np.ndarray, outputs: np.ndarray, lines: np.ndarray) -> Fitted:
    """scikit-learn: tanh, L-BFGS, layers by cross-validation."""

    def fit(layers: tuple[int, ...], inputs: np.ndarray, outputs: np.ndarray) -> MLPRegressor:
        model = MLPRegressor(
            hidden_layer_sizes=layers,
            activation="tanh",
            solver="lbfgs",
            alpha=DECAY,
            max_iter=ITERATIONS,
            max_fun=10 * ITERATIONS,
            tol=1e-9,
            random_state=SEED,
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the most iterations
            return model.fit(inputs, outputs if outputs.shape[1] > 1 else outputs.ravel())

    layers = chosen(NETWORKS, fit, lambda model, places: model.predict(places), (inputs, outputs, lines))
    model = fit(layers, inputs, outputs)
    return Fitted(
        lambda places: model.predict(places).reshape(len(places), -1),
        len(pickle.dumps(model)),
        f"layers of {', '.join(map(str, layers))} neurons",
    )


def separated(inputs: np.ndarray, outputs: np.ndarray, lines: np.ndarray) -> Fitted:
    """TensorLy: CP regression on products of Chebyshev polynomials, so a separated form of scattered states.

    Its degree, its rank and the weight of its norm are those that cross-validation finds.
    """

    def fit(
        sizes: tuple[int, int, float], inputs: np.ndarray, outputs: np.ndarray, sweeps: int = TRIAL_SWEEPS
    ) -> CPRegressor:
        _, rank, ridge = sizes
        model = CPRegressor(rank, reg_W=ridge, n_iter_max=sweeps, tol=1e-8, verbose=0, random_state=SEED)
        return model.fit(products(inputs, sizes[0]), outputs)

    def ask(model: CPRegressor, places: np.ndarray) -> np.ndarray:
        return model.predict(products(places, len(model.cp_weight_[1][0]) - 1))

    sizes = chosen(SEPARATED, fit, ask, (inputs, outputs, lines))
    model = fit(sizes, inputs, outputs, SWEEPS)
    size = sum(factor.nbytes for factor in model.cp_weight_[1])
    return Fitted(lambda places: ask(model, places), size, f"degree {sizes[0]}, rank {sizes[1]}")


def products(places: np.ndarray, degree: int) -> np.ndarray:
    """Products of Chebyshev polynomials of [0, 1] along every axis, shape (n, degree + 1, degree + 1, ...)."""
    along = [chebvander(2 * axis - 1, degree) for axis in places.T]
    return reduce(lambda found, axis: found[..., None] * axis.reshape(len(axis), *[1] * (found.ndim - 1), -1), along)


def chosen(
    candidates: Iterable[Any],
    fit: Callable[[Any, np.ndarray, np.ndarray], Any],
    ask: Callable[[Any, np.ndarray], np.ndarray],
    states: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> Any:
    """The candidate that predicts lines best that it was not given: least mean square of errors of inputs, outputs."""
    inputs, outputs, lines = states

    def missed(candidate: Any) -> float:
        found = []
        for own, others in GroupKFold(FOLDS).split(inputs, groups=lines):
            told = np.reshape(ask(fit(candidate, inputs[own], outputs[own]), inputs[others]), outputs[others].shape)
            found.append(float(np.mean((told - outputs[others]) ** 2)))
        return float(np.mean(found))

    return min(candidates, key=missed)


# By package and method.
METHODS: dict[tuple[str, str], Method] = {
    ("EZyRB", "POD, RBF"): radial,
    ("EZyRB", "POD, GPR"): ezyrb_gaussian,
    ("scikit-learn", "Gaussian process"): gaussian,
    ("scikit-learn", "neural network"): network,
    ("TensorLy", "CP regression"): separated,
}
