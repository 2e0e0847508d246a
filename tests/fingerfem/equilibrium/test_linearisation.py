"""The factorised tangent: it solves, counts negative eigenvalues, and judges stability."""

import numpy as np
import pytest
from petsc4py import PETSc

from fingerfem.equilibrium.factorisation import Factorisation
from fingerfem.equilibrium.linearisation import Linearisation


class Antisymmetric:
    """Motions out of the half's plane, which give way or not; it counts how often it is asked."""

    def __init__(self, gives_way: bool = False):
        self.answer, self.asked = gives_way, 0

    def gives_way(self) -> bool:
        self.asked += 1
        return self.answer


def symmetric(eigenvalues, seed: int = 0) -> np.ndarray:
    """A full matrix of these eigenvalues."""
    n = len(eigenvalues)
    axes = np.linalg.qr(np.random.default_rng(seed).standard_normal((n, n)))[0]
    whole = (axes * eigenvalues) @ axes.T
    return (whole + whole.T) / 2


def assembled(whole: np.ndarray) -> PETSc.Mat:
    n = len(whole)
    rows = np.arange(0, n * n + 1, n, dtype=PETSc.IntType)
    columns = np.tile(np.arange(n, dtype=PETSc.IntType), n)
    return PETSc.Mat().createAIJ((n, n), csr=(rows, columns, whole.ravel()), comm=PETSc.COMM_SELF)


def factorised(whole: np.ndarray, antisymmetric: Antisymmetric) -> tuple[Linearisation, Factorisation]:
    factors = Factorisation(assembled(whole))
    assert factors.update() is None
    return Linearisation(factors, antisymmetric), factors


def vector(values: np.ndarray) -> PETSc.Vec:
    return PETSc.Vec().createWithArray(values.copy(), comm=PETSc.COMM_SELF)


@pytest.mark.parametrize("negative", [0, 1, 3, 12])
def test_negative_pivots_are_negative_eigenvalues_and_it_solves_whatever_their_number(negative):
    sizes = np.geomspace(1.0, 1e4, 12)
    whole = symmetric(np.where(np.arange(12) < negative, -sizes, sizes), seed=negative)
    one, _ = factorised(whole, Antisymmetric())
    assert one.negative_pivots == negative == int((np.linalg.eigvalsh(whole) < 0).sum())
    pushed = np.random.default_rng(1).standard_normal(12)
    assert whole @ one.solve(vector(pushed)) == pytest.approx(pushed, abs=1e-9)


@pytest.mark.parametrize(("negative", "gives_way", "stable"), [(0, False, True), (0, True, False), (1, False, False)])
def test_it_is_stable_if_no_motion_of_the_whole_finger_gives_way(negative, gives_way, stable):
    apart = Antisymmetric(gives_way)
    one, _ = factorised(symmetric([-1.0 if k < negative else 1.0 + k for k in range(6)]), apart)
    assert one.stable is stable and one.stable is stable
    assert apart.asked == (0 if negative else 1)  # that takes a factorisation of its own


def test_it_holds_until_the_next_tangent_and_each_has_its_own_answer():
    """A tangent twice as stiff gives way by half as much."""
    whole, pushed = symmetric(np.arange(1.0, 6.0)), np.arange(5.0)
    one, factors = factorised(whole, Antisymmetric())
    first = one.solve(vector(pushed))
    factors.matrix.scale(2.0)
    assert factors.update() is None
    with pytest.raises(RuntimeError, match="a linearisation must be used before the next tangent is factorised"):
        one.solve(vector(pushed))
    other = Linearisation(factors, Antisymmetric())
    assert other.solve(vector(pushed)) == pytest.approx(first / 2) and first.any()


def test_at_rest_the_finger_s_tangent_is_stable_and_its_solution_is_in_balance(draft):
    draft.continuation.rest()
    linearisation, problem = draft.continuation.linearise(), draft.problem
    pulled = problem.load_gradient([1.0, 0.0])
    expected, product = pulled.array_r.copy(), pulled.duplicate()
    solution = pulled.duplicate()
    solution.array[:] = linearisation.solve(pulled)
    problem.matrix.mult(solution, product)
    assert product.array_r == pytest.approx(expected, abs=1e-9 * np.abs(expected).max()) and expected.any()
    assert linearisation.stable and linearisation.negative_pivots == 0
    assert not solution.array_r[problem.held].any()
    for one in (solution, product):
        one.destroy()
