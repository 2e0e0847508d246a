"""Nominal stresses of incompressible rubber are those of closed forms."""

import numpy as np
import pytest

from fingerfem.material_fit.stresses import EXPONENTS, nominal_stress, principal_stretches
from fingerfem.scene.laws import MooneyRivlin, NeoHookean, Ogden, Yeoh

D1 = 1e-8  # [1/Pa], which has no part in it
STRETCH = np.concatenate([np.linspace(0.5, 0.95, 10), np.linspace(1.05, 2.2, 10)])
# By Treloar, The physics of rubber elasticity, chapter 5: P = 2 f (C1 + g C01), with f and g of the test.
NEO_HOOKEAN = {"uniaxial": -2, "equibiaxial": -5, "planar": -3}  # f = l - l^k
SECOND = {"uniaxial": -1, "equibiaxial": 2, "planar": 0}  # g = l^k


@pytest.mark.parametrize("mode", EXPONENTS)
def test_the_neo_hookean_law_and_mooney_rivlin_s_have_the_closed_forms(mode):
    f, g = STRETCH - STRETCH ** NEO_HOOKEAN[mode], STRETCH ** SECOND[mode]
    assert nominal_stress(NeoHookean(C1=1e5, D1=D1), mode, STRETCH) == pytest.approx(2e5 * f, rel=1e-12)
    assert nominal_stress(MooneyRivlin(C10=1e5, C01=2e4, D1=D1), mode, STRETCH) == pytest.approx(
        2 * f * (1e5 + 2e4 * g), rel=1e-12
    )


@pytest.mark.parametrize("mode", EXPONENTS)
def test_yeoh_s_law_is_the_neo_hookean_one_times_a_polynomial_of_i1(mode):
    excess = (principal_stretches(mode, STRETCH) ** 2).sum(axis=1) - 3
    expected = 2 * (STRETCH - STRETCH ** NEO_HOOKEAN[mode]) * (1e5 + 2 * 4e3 * excess + 3 * 5e2 * excess**2)
    assert nominal_stress(Yeoh(C1=1e5, C2=4e3, C3=5e2, D1=D1), mode, STRETCH) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("mode", "side"), [("uniaxial", -0.5), ("equibiaxial", -2.0), ("planar", -1.0)])
def test_ogden_s_law_is_a_sum_of_powers(mode, side):
    expected = sum(
        mu * (STRETCH ** (alpha - 1) - STRETCH ** (side * alpha - 1)) for mu, alpha in ((1e5, 1.3), (-2e4, -2.7))
    )
    law = Ogden(mu=[1e5, -2e4], alpha=[1.3, -2.7], D1=D1)
    assert nominal_stress(law, mode, STRETCH) == pytest.approx(expected, rel=2e-6, abs=1e-6 * 1e5)


@pytest.mark.parametrize("mode", EXPONENTS)
def test_no_test_changes_the_volume(mode):
    assert principal_stretches(mode, STRETCH).prod(axis=1) == pytest.approx(1.0, rel=1e-12)
