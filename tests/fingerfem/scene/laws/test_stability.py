"""A law is stable up to a stretch that closed forms give, and refused if that is within its data."""

import numpy as np
import pytest
from pydantic import ValidationError

from fingerfem.scene.laws import MooneyRivlin, Ogden, Yeoh
from fingerfem.scene.laws.law import USUAL_STRETCHES, loss_of_constants
from fingerfem.scene.laws.stability import MODES, ends, first_loss, loss, stress

SILICONE = {"C10": 10.6e3, "C01": -4.2e3, "D1": 3e-7}  # a published fit
INCOMPRESSIBLE = 1e-12  # D1 [1/Pa]


def unchecked(C10: float, C01: float, D1: float) -> MooneyRivlin:
    return MooneyRivlin.model_construct(law="mooney-rivlin", C10=C10, C01=C01, D1=D1)


def closed_form(ratio: float, mode: str) -> float:
    """Stretch at which incompressible rubber of C01 = ratio C10 loses stability, by a_1, a_2, a_3 on a fine grid."""
    stretches = np.exp(np.linspace(-0.6, 0.6, 1_200_001))
    exponents = {"uniaxial": (1.0, -0.5, -0.5), "equibiaxial": (1.0, 1.0, -2.0), "planar": (1.0, 0.0, -1.0)}[mode]
    a = [stretches ** (2 * k) + ratio * stretches ** (-2 * k) for k in exponents]
    pairs = [(0, 1), (1, 2), (2, 0)]
    stable = np.min([a[i] + a[j] for i, j in pairs], axis=0) > 0
    stable &= sum(a[i] * a[j] for i, j in pairs) > 0
    return float(min(stretches[~stable], key=lambda stretch: abs(np.log(stretch)), default=np.inf))


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("ratio", [-0.5, -0.6, -0.8])
def test_incompressible_rubber_loses_stability_where_the_closed_form_does(mode, ratio):
    constants = unchecked(1e4, ratio * 1e4, INCOMPRESSIBLE)
    # Of planar stretch, lambda and 1 / lambda are the same states.
    found = abs(np.log(loss(constants, mode, USUAL_STRETCHES)))
    assert found == pytest.approx(abs(np.log(closed_form(ratio, mode))), abs=3e-6)


def test_uniaxial_stretch_is_stable_between_two_roots():
    """In tension up to C10 / lambda + C01 lambda = 0, where the two free directions part."""
    tension = (1e4 / 8e3) ** 0.5
    roots = np.roots([2e4, -8e3, 0, 1e4, -16e3])  # 2 C10 x^4 + C01 x^3 + C10 x + 2 C01 = 0
    (compression,) = roots[(abs(roots.imag) < 1e-9) & (roots.real > 0)].real
    nearest = min(tension, compression, key=lambda stretch: abs(np.log(stretch)))
    constants = unchecked(1e4, -8e3, INCOMPRESSIBLE)
    assert loss(constants, "uniaxial", USUAL_STRETCHES) == pytest.approx(nearest, rel=1e-6)
    assert loss(constants, "equibiaxial", USUAL_STRETCHES) == pytest.approx(nearest**-0.5, rel=1e-6)  # the same states


def test_stresses_and_their_derivatives_are_those_of_the_energy():
    constants, e, h = unchecked(1e4, -3e3, 1e-5), np.array([0.2, -0.15, 0.02]), 1e-5

    def energy(e: np.ndarray) -> float:
        C, J = np.exp(2 * e), np.exp(e.sum())
        I1bar, I2 = J ** (-2 / 3) * C.sum(), (C.sum() ** 2 - (C**2).sum()) / 2
        C10, C01, D1 = constants.C10, constants.C01, constants.D1
        return C10 * (I1bar - 3) + C01 * (I2 - 3 - 4 * np.log(J)) + (J - 1) ** 2 / D1

    tau, slope = stress(constants, e)
    steps = h * np.eye(3)
    assert tau == pytest.approx([(energy(e + step) - energy(e - step)) / (2 * h) for step in steps], rel=1e-7)
    differences = [(stress(constants, e + step)[0] - stress(constants, e - step)[0]) / (2 * h) for step in steps]
    assert slope == pytest.approx(np.array(differences), rel=1e-7)


def test_a_published_fit_with_a_negative_constant_is_accepted_with_the_right_moduli():
    law = MooneyRivlin(**SILICONE)
    assert first_loss(MooneyRivlin(**SILICONE), USUAL_STRETCHES) is None
    assert law.shear_modulus == pytest.approx(12.8e3)
    assert law.bulk_modulus == pytest.approx(2 / 3e-7 - 16 / 3 * 4.2e3)
    assert law.is_mixed


@pytest.mark.parametrize(
    ("changed", "rule"),
    [
        (
            {"C01": -8e3},
            r"stable at all stretches from 0.7 to 1.5, got C10 = 10600, C01 = -8000, .* at (0.93|1.07). in equi",
        ),
        ({"C01": -11e3}, r"shear and a bulk modulus above 0 Pa at small strain, got -800 and"),
        ({"D1": 1e-4}, r"shear and a bulk modulus above 0 Pa at small strain, got 1.28e\+04 and -2.4e\+03"),
        ({"D1": 5e-5}, r"lose stability at 0.881 in equibiaxial"),  # by its volume
    ],
)
def test_a_law_that_is_not_stable_is_refused_with_the_stretch(changed, rule):
    with pytest.raises(ValidationError, match=rule):
        MooneyRivlin(**SILICONE | changed)


@pytest.mark.parametrize("ratio", np.linspace(-0.2, -0.9, 15))
def test_a_law_is_accepted_exactly_where_the_closed_form_is_stable_within_the_range(ratio):
    bounds = {mode: np.log(ends(mode, USUAL_STRETCHES)) for mode in MODES}
    assert bounds["uniaxial"] == pytest.approx(np.log(USUAL_STRETCHES))
    lost = any(low <= np.log(closed_form(ratio, mode)) <= high for mode, (low, high) in bounds.items())
    assert (first_loss(unchecked(1e4, ratio * 1e4, INCOMPRESSIBLE), USUAL_STRETCHES) is not None) == lost


def closed_form_of_yeoh(ratio: float) -> float:
    """Stretch of the largest Kirchhoff stress in incompressible uniaxial tension of C2 = ratio C1, on a fine grid."""
    stretch = np.exp(np.linspace(0, 1, 1_000_001))
    excess = stretch**2 + 2 / stretch - 3
    tau = 2 * (stretch**2 - 1 / stretch) * (1 + 2 * ratio * excess)
    return float(stretch[np.argmax(np.diff(tau) < 0)])


def test_yeoh_s_law_with_a_negative_constant_loses_stability_at_its_largest_stress():
    law = Yeoh.model_construct(law="yeoh", C1=1e4, C2=-2e3, C3=0.0, D1=INCOMPRESSIBLE)
    found = loss(law, "uniaxial", (0.3, 2.7))
    assert found == pytest.approx(closed_form_of_yeoh(-0.2), rel=1e-5)


def test_a_law_is_checked_between_the_stretches_of_its_data():
    constants = {"C1": 1e4, "C2": -2e3, "D1": 1e-8}
    Yeoh(**constants, stretches=[0.8, 1.5])
    with pytest.raises(ValidationError, match=r"from 0.5 to 3, got C1 = 10000, C2 = -2000, .* at 0.77. in equibiaxial"):
        Yeoh(**constants, stretches=[0.5, 3.0])
    with pytest.raises(ValidationError, match=r"with 1 between them, got \[1.1, 2.0\]"):
        Yeoh(**constants, stretches=[1.1, 2.0])


def test_ogden_s_law_of_powers_two_and_minus_two_is_mooney_rivlin_s():
    """Each alone at J = 1, where loss of stability does not see the volume."""
    ogden = Ogden.model_construct(law="ogden", mu=[2e4, 1.6e4], alpha=[2.0, -2.0], D1=INCOMPRESSIBLE)
    e = np.array([0.2, -0.15, -0.05])
    tau, other = (stress(law, e)[0] for law in (ogden, unchecked(1e4, -0.8e4, INCOMPRESSIBLE)))
    assert tau - tau.mean() == pytest.approx(other - other.mean(), rel=1e-12)
    found = loss(ogden, "uniaxial", USUAL_STRETCHES)
    assert found == pytest.approx(loss(unchecked(1e4, -0.8e4, INCOMPRESSIBLE), "uniaxial", USUAL_STRETCHES), rel=1e-5)


def test_equal_constants_are_checked_once_and_other_ones_or_stretches_anew():
    table = {"mu": [1.1e5], "alpha": [2.3], "D1": 1e-7}
    loss_of_constants.cache_clear()
    checks = []
    for change in ({}, {}, {"formulation": "mixed"}, {"alpha": [2.4]}, {"stretches": [0.6, 1.4]}):
        Ogden(**table | change)
        checks.append(loss_of_constants.cache_info().misses)
    assert checks == [1, 1, 1, 2, 3]
