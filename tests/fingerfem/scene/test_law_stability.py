"""A Mooney-Rivlin law with C01 < 0 is stable up to a stretch that closed forms give, and refused if that is near."""

import numpy as np
import pytest
from pydantic import ValidationError

from fingerfem.scene.law_stability import LONGEST, MODES, SHORTEST, Constants, first_loss, loss, stress
from fingerfem.scene.laws import MooneyRivlin

SILICONE = {"C10": 10.6e3, "C01": -4.2e3, "D1": 3e-7}  # a published fit
INCOMPRESSIBLE = 1e-12  # D1 [1/Pa]


def closed_form(ratio: float, mode: str) -> float:
    """Where incompressible rubber of C01 = ratio C10 loses stability, by a_1, a_2, a_3 on a fine grid of stretches."""
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
    constants = Constants(1e4, ratio * 1e4, INCOMPRESSIBLE)
    # Of planar stretch, lambda and 1 / lambda are the same states.
    found, expected = (abs(np.log(stretch)) for stretch in (loss(constants, mode), closed_form(ratio, mode)))
    assert found == pytest.approx(expected, abs=3e-6)


def test_uniaxial_stretch_is_stable_between_two_roots():
    """In tension up to C10 / lambda + C01 lambda = 0, where the two free directions part."""
    tension = (1e4 / 8e3) ** 0.5
    roots = np.roots([2e4, -8e3, 0, 1e4, -16e3])  # 2 C10 x^4 + C01 x^3 + C10 x + 2 C01 = 0
    (compression,) = roots[(abs(roots.imag) < 1e-9) & (roots.real > 0)].real
    nearest = min(tension, compression, key=lambda stretch: abs(np.log(stretch)))
    constants = Constants(1e4, -8e3, INCOMPRESSIBLE)
    assert loss(constants, "uniaxial") == pytest.approx(nearest, rel=1e-6)
    assert loss(constants, "equibiaxial") == pytest.approx(nearest**-0.5, rel=1e-6)  # the same states


def test_stresses_and_their_derivatives_are_those_of_the_energy():
    constants, e, h = Constants(1e4, -3e3, 1e-5), np.array([0.2, -0.15, 0.02]), 1e-5

    def energy(e: np.ndarray) -> float:
        C, J = np.exp(2 * e), np.exp(e.sum())
        I1bar, I2 = J ** (-2 / 3) * C.sum(), (C.sum() ** 2 - (C**2).sum()) / 2
        C10, C01, D1 = constants
        return C10 * (I1bar - 3) + C01 * (I2 - 3 - 4 * np.log(J)) + (J - 1) ** 2 / D1

    tau, slope = stress(constants, e)
    steps = h * np.eye(3)
    assert tau == pytest.approx([(energy(e + step) - energy(e - step)) / (2 * h) for step in steps], rel=1e-7)
    differences = [(stress(constants, e + step)[0] - stress(constants, e - step)[0]) / (2 * h) for step in steps]
    assert slope == pytest.approx(np.array(differences), rel=1e-7)


def test_a_published_fit_with_a_negative_constant_is_accepted_with_the_right_moduli():
    law = MooneyRivlin(**SILICONE)
    assert first_loss(Constants(**SILICONE)) is None
    assert law.shear_modulus == pytest.approx(12.8e3)
    assert law.bulk_modulus == pytest.approx(2 / 3e-7 - 16 / 3 * 4.2e3)
    assert law.is_mixed


@pytest.mark.parametrize(
    ("changed", "rule"),
    [
        (
            {"C01": -8e3},
            r"stable at all stretches from 0.7 to 1.5, got C01 = -8000 Pa .* at (0.93|1.07). in equi",
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
    bounds = {mode: np.log(ends) for mode, (_, _, ends) in MODES.items()}
    assert bounds["uniaxial"] == pytest.approx(np.log([SHORTEST, LONGEST]))
    lost = any(low <= np.log(closed_form(ratio, mode)) <= high for mode, (low, high) in bounds.items())
    assert (first_loss(Constants(1e4, ratio * 1e4, INCOMPRESSIBLE)) is not None) == lost
