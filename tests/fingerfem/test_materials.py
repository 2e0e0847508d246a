"""The neo-Hookean energy: its rest, its moduli, its objectivity and its stress."""

import numpy as np
import pytest
import ufl
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fingerfem.materials import NeoHookean, neo_hookean_from, stress

RUBBER = NeoHookean(C1=1.9e6, D1=2.43e-7)


def energy(F: np.ndarray) -> float:
    return float(RUBBER(ufl.as_matrix((F.T @ F).tolist()))(()))


def second_piola(C: np.ndarray) -> np.ndarray:
    S = stress(RUBBER, ufl.as_matrix(C.tolist()))
    S = ufl.algorithms.apply_derivatives.apply_derivatives(
        ufl.algorithms.apply_algebra_lowering.apply_algebra_lowering(S)
    )
    return np.array([[float(S[i, j](())) for j in range(3)] for i in range(3)])


def stretched(seed: int) -> np.ndarray:
    return np.eye(3) + 0.2 * np.random.default_rng(seed).standard_normal((3, 3))


def test_moduli_are_those_of_the_paper():
    assert RUBBER.shear_modulus == pytest.approx(3.8e6)
    assert RUBBER.bulk_modulus == pytest.approx(8.23e6, rel=1e-3)
    assert RUBBER.young_modulus == pytest.approx(9.88e6, rel=1e-3)
    assert RUBBER.poisson == pytest.approx(0.300, abs=1e-3)


@given(st.floats(1e3, 1e12), st.floats(-0.9, 0.49))
def test_a_law_made_from_moduli_has_them(young_modulus, poisson):
    law = neo_hookean_from(young_modulus, poisson)
    assert law.young_modulus == pytest.approx(young_modulus, rel=1e-9)
    assert law.poisson == pytest.approx(poisson, abs=1e-9)


def test_rest_has_no_energy_and_no_stress():
    assert energy(np.eye(3)) == pytest.approx(0.0, abs=1e-8)
    assert np.abs(second_piola(np.eye(3))).max() < 1e-8 * RUBBER.young_modulus


@pytest.mark.parametrize("seed", range(4))
def test_energy_does_not_see_rotations(seed):
    F, R = stretched(seed), Rotation.random(random_state=seed).as_matrix()
    assert energy(R @ F) == pytest.approx(energy(F), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_stress_is_the_derivative_of_the_energy(seed):
    F = stretched(seed)
    C = F.T @ F
    S, h = second_piola(C), 1e-5

    def of(C):
        return float(RUBBER(ufl.as_matrix(C.tolist()))(()))

    for i, j in ((0, 0), (1, 1), (0, 1), (1, 2)):
        dC = np.zeros((3, 3))
        dC[i, j] += 0.5
        dC[j, i] += 0.5
        slope = (of(C + h * dC) - of(C - h * dC)) / (2 * h)
        assert S[i, j] == pytest.approx(2 * slope, rel=1e-7, abs=1e-6 * RUBBER.shear_modulus)


def test_uniaxial_tension_at_small_strain_follows_hooke():
    strain = 1e-5
    lateral = 1 - RUBBER.poisson * strain
    S = second_piola(np.diag([(1 + strain) ** 2, lateral**2, lateral**2]))
    assert S[0, 0] == pytest.approx(RUBBER.young_modulus * strain, rel=1e-3)
    assert abs(S[1, 1]) < 1e-3 * S[0, 0]


@pytest.mark.parametrize(("name", "value"), [("C1", 0.0), ("D1", -1.0), ("C1", float("nan"))])
def test_parameters_must_be_positive(name, value):
    with pytest.raises(ValueError, match=f"{name} must be positive"):
        NeoHookean(**{"C1": 1.0, "D1": 1.0, name: value})
