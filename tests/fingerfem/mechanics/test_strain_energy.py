"""Laws are energies: their rest, moduli, objectivity and stress; their ranges."""

import numpy as np
import pytest
import ufl
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from fingerfem.mechanics.strain_energy import elasticity, energy, of_strain, parts, stress
from fingerfem.scene.laws import MooneyRivlin, NeoHookean, Ogden, SaintVenantKirchhoff, Yeoh, neo_hookean_from

PAPER = NeoHookean(C1=1.9e6, D1=2.43e-7)
LAWS = [
    PAPER,
    MooneyRivlin(C10=1.5e6, C01=0.4e6, D1=2.43e-7),
    Yeoh(C1=1.9e6, C2=0.3e6, C3=0.02e6, D1=2.43e-7),
    Ogden(mu=[2.6e6, -0.2e6], alpha=[2.5, -1.3], D1=2.43e-7),
    SaintVenantKirchhoff(E=9.88e6, nu=0.3),
]
every_law = pytest.mark.parametrize("law", LAWS, ids=lambda law: law.law)


def value(law, C: np.ndarray) -> float:
    return float(energy(law)(ufl.as_matrix(C.tolist()))(()))


def second_piola(law, C: np.ndarray) -> np.ndarray:
    S = lowered(stress(energy(law), ufl.as_matrix(C.tolist())))
    return np.array([[float(S[i, j](())) for j in range(3)] for i in range(3)])


def lowered(expression):
    """An expression that may be evaluated."""
    return ufl.algorithms.apply_derivatives.apply_derivatives(
        ufl.algorithms.apply_algebra_lowering.apply_algebra_lowering(expression)
    )


def stretched(seed: int) -> np.ndarray:
    return np.eye(3) + 0.2 * np.random.default_rng(seed).standard_normal((3, 3))


def test_moduli_are_those_of_the_paper():
    assert PAPER.shear_modulus == pytest.approx(3.8e6)
    assert PAPER.bulk_modulus == pytest.approx(8.23e6, rel=1e-3)
    assert PAPER.young_modulus == pytest.approx(9.88e6, rel=1e-3)
    assert PAPER.poisson == pytest.approx(0.300, abs=1e-3)


@given(st.floats(1e4, 1e11), st.floats(0.0, 0.49))
def test_a_law_made_from_moduli_has_them(young_modulus, poisson):
    law = neo_hookean_from(young_modulus, poisson)
    assert law.young_modulus == pytest.approx(young_modulus, rel=1e-9)
    assert law.poisson == pytest.approx(poisson, abs=1e-9)


def test_mooney_rivlin_without_its_second_constant_is_neo_hookean():
    law, C = MooneyRivlin(C10=1.9e6, C01=0.0, D1=2.43e-7), stretched(7).T @ stretched(7)
    assert value(law, C) == pytest.approx(value(PAPER, C), rel=1e-14)


@every_law
def test_rest_has_no_energy_and_no_stress(law):
    assert value(law, np.eye(3)) == pytest.approx(0.0, abs=1e-8)
    assert np.abs(second_piola(law, np.eye(3))).max() < 1e-8 * law.young_modulus


@every_law
@pytest.mark.parametrize("seed", range(4))
def test_energy_does_not_see_rotations(law, seed):
    F, R = stretched(seed), Rotation.random(random_state=seed).as_matrix()
    assert value(law, (R @ F).T @ (R @ F)) == pytest.approx(value(law, F.T @ F), rel=1e-12)


WHOLE_POWERS = Ogden(mu=[1e6, -2e5], alpha=[4.0, -2.0], D1=2.43e-7)  # fractional ones take long in Python


@pytest.mark.parametrize("law", [*LAWS[:3], WHOLE_POWERS, LAWS[-1]], ids=lambda law: law.law)
def test_elasticity_is_the_second_derivative_of_the_energy(law):
    C, H, h = stretched(4).T @ stretched(4), stretched(5).T @ stretched(5), 1e-4
    tensor = elasticity(energy(law), ufl.as_matrix(C.tolist()))
    along = ufl.as_matrix(H.tolist())
    found = float(lowered(ufl.inner(tensor, ufl.outer(along, along)))(()))
    behind, here, ahead = (value(law, C + step * H) for step in (-h, 0.0, h))
    assert found == pytest.approx(4 * (behind - 2 * here + ahead) / h**2, rel=1e-5)


@every_law
@pytest.mark.parametrize("seed", range(3))
def test_stress_is_the_derivative_of_the_energy(law, seed):
    C, h = stretched(seed).T @ stretched(seed), 1e-5
    S = second_piola(law, C)
    for i, j in ((0, 0), (1, 1), (0, 1), (1, 2)):
        dC = np.zeros((3, 3))
        dC[i, j] += 0.5
        dC[j, i] += 0.5
        slope = (value(law, C + h * dC) - value(law, C - h * dC)) / (2 * h)
        assert S[i, j] == pytest.approx(2 * slope, rel=1e-7, abs=1e-6 * law.shear_modulus)


@every_law
def test_small_strain_follows_hooke_with_the_laws_own_moduli(law):
    strain = 1e-5
    lateral = 1 - law.poisson * strain
    S = second_piola(law, np.diag([(1 + strain) ** 2, lateral**2, lateral**2]))
    assert S[0, 0] == pytest.approx(law.young_modulus * strain, rel=1e-3)
    assert abs(S[1, 1]) < 1e-3 * S[0, 0]
    shear = np.eye(3)
    shear[0, 1] = shear[1, 0] = strain
    assert second_piola(law, shear)[0, 1] == pytest.approx(law.shear_modulus * strain, rel=1e-3)


@pytest.mark.parametrize("law", LAWS[:3], ids=lambda law: law.law)
@pytest.mark.parametrize("seed", range(20))
def test_polyconvex_laws_are_convex_along_rank_one_lines(law, seed):
    """Legendre-Hadamard, which polyconvexity implies, at states far from rest."""
    draw = np.random.default_rng(seed)
    F = np.eye(3) + 0.5 * draw.standard_normal((3, 3))
    F *= np.sign(np.linalg.det(F))
    a, b = draw.standard_normal((2, 3))
    h = 1e-3 / np.linalg.norm(np.outer(a, b) @ np.linalg.inv(F))
    ahead, here, behind = (value(law, (F + t * np.outer(a, b)).T @ (F + t * np.outer(a, b))) for t in (h, 0.0, -h))
    assert ahead - 2 * here + behind > 0


def test_a_law_splits_into_two_parts_that_make_the_whole():
    C = ufl.as_matrix((stretched(1).T @ stretched(1)).tolist())
    for law in LAWS[:4]:
        distortional, volumetric = parts(law)
        J = ufl.sqrt(ufl.det(C))
        assert float((distortional(C) + volumetric(J))(())) == pytest.approx(float(energy(law)(C)(())), rel=1e-14)


@pytest.mark.parametrize("C01", [0.4e6, -0.4e6])
def test_the_part_beside_the_pressure_s_resists_no_small_change_of_volume(C01):
    """Otherwise a negative C01 softens every cell between the few points that see the pressure."""
    distortional, volumetric = parts(MooneyRivlin(C10=1.5e6, C01=C01, D1=1e-9))
    J = np.array([0.999, 1.0, 1.001])

    def swollen(part) -> np.ndarray:
        return np.array([float(part(ufl.as_matrix((j ** (2 / 3) * np.eye(3)).tolist()))(())) for j in J])

    assert np.abs(swollen(distortional)).max() < 1e-8
    assert np.diff(swollen(of_strain(volumetric)), 2)[0] / 1e-6 == pytest.approx(2e9 + 16 / 3 * C01, rel=1e-5)


@pytest.mark.parametrize("alpha", [2.0, -2.0, 1.3, 9.4, -3.7])
def test_ogden_s_energy_is_that_of_its_stretches(alpha):
    law, F = Ogden.model_construct(law="ogden", mu=[1e6], alpha=[alpha], D1=1e-7), stretched(3)
    stretches, J = np.linalg.svd(F)[1], np.linalg.det(F)
    expected = 1e6 / alpha * (((stretches / J ** (1 / 3)) ** alpha).sum() - 3) + (J - 1) ** 2 / 1e-7
    assert value(law, F.T @ F) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("law", "name", "value"),
    [
        (NeoHookean, "C1", 0.0),
        (NeoHookean, "D1", -1.0),
        (NeoHookean, "C1", float("nan")),
        (MooneyRivlin, "C01", -6e5),  # not stable
        (SaintVenantKirchhoff, "nu", 0.46),
        (SaintVenantKirchhoff, "nu", -0.1),
        (NeoHookean, "D1", 2e-6),  # Poisson's ratio -0.2
        (SaintVenantKirchhoff, "E", -1.0),
    ],
)
def test_parameters_must_lie_in_the_laws_range(law, name, value):
    good = {NeoHookean: {"C1": 1e6, "D1": 1e-7}, MooneyRivlin: {"C10": 1e6, "C01": 1e5, "D1": 1e-7}}
    parameters = good.get(law, {"E": 1e7, "nu": 0.3}) | {name: value}
    with pytest.raises(ValidationError, match=f"{name}|Poisson's ratio of at least 0"):
        law(**parameters)


def test_rubber_is_mixed_by_itself_above_a_poissons_ratio_of_045():
    assert not neo_hookean_from(1e7, 0.4499).is_mixed
    assert neo_hookean_from(1e7, 0.4501).is_mixed
    assert NeoHookean(C1=1.9e6, D1=2.43e-7, formulation="mixed").is_mixed
