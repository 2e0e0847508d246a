"""Constants by modulus or by hardness, for every law that has them."""

import pytest
from pydantic import ValidationError

from fingerfem.scene.laws import MooneyRivlin, NeoHookean, Ogden, Yeoh
from fingerfem.scene.laws.hardness import modulus_of_shore_a

MOONEY = [(MooneyRivlin, {}), (MooneyRivlin, {"C01": 2e5})]
GIVEN = [(NeoHookean, {}), *MOONEY, (Yeoh, {"C2": 1e4}), (Ogden, {"alpha": [3.4]})]


@pytest.mark.parametrize(("law", "beside"), GIVEN)
@pytest.mark.parametrize("nu", [0.3, 0.4999])
def test_a_law_by_its_moduli_has_them(law, beside, nu):
    found = law.model_validate({"E": 2e6, "nu": nu, **beside})
    assert found.young_modulus == pytest.approx(2e6, rel=1e-12)
    assert found.poisson == pytest.approx(nu, rel=1e-9)


def test_hardness_30_has_the_modulus_of_gent_s_formula_by_hand():
    assert modulus_of_shore_a(30) == pytest.approx(0.0981e6 * (56 + 228.7008) / (0.137505 * 177.8), rel=1e-12)
    with pytest.warns(UserWarning, match=r"shore_A = 30 gives E = 1.14 MPa; .* silicones gave 0.3 to 0.51 of"):
        law = Yeoh.model_validate({"shore_A": 30.0})
    assert law.young_modulus == pytest.approx(modulus_of_shore_a(30)) and law.poisson == pytest.approx(0.499)


def test_displacements_alone_are_warned_of_in_nearly_incompressible_rubber():
    with pytest.warns(UserWarning, match=r"formulation = displacement makes cells too stiff at nu = 0.4999"):
        NeoHookean.model_validate({"E": 3e5, "nu": 0.4999, "formulation": "displacement"})


@pytest.mark.parametrize(
    ("law", "table", "rule"),
    [
        (NeoHookean, {"E": 1e6}, "nu must be given beside E, got E = 1000000"),
        (NeoHookean, {"E": 1e6, "nu": 0.5}, "nu must be from 0 to 0.49999, such as 0.499 of most rubbers, got 0.5"),
        (NeoHookean, {"E": 0.3, "nu": 0.49}, "E must be from 1000 to 1e.11 Pa, got 0.3"),
        (NeoHookean, {"E": True, "nu": 0.3}, "E and nu must be numbers, got True"),
        (MooneyRivlin, {"E": 1e6, "nu": 0.49, "C01": "x"}, "C01 must be a number below 3/16"),
        (MooneyRivlin, {"E": 1e6, "nu": 0.3, "C01": 1e6}, "C01 must be a number below 3/16"),
        (Ogden, {"mu": [1e5, 1e4], "alpha": [2.0, 0.0], "D1": 1e-8}, "must be at least 0.01 in size, got 0"),
        (Ogden, {"mu": [1e5, 1e4], "alpha": [2.0], "D1": 1e-8}, "must have as many numbers as mu .2., got 1"),
        (NeoHookean, {"E": 1e6, "nu": 0.3, "C1": 1e5}, "C1 must be left out beside E, got 100000"),
        (NeoHookean, {"E": 1e6, "nu": 0.3, "shore_A": 30.0}, "E must be left out beside shore_A, got 1000000"),
        (NeoHookean, {"E": "soft", "nu": 0.3}, "E and nu must be numbers, got 'soft' and 0.3"),
        (NeoHookean, {"shore_A": 95.0}, "shore_A must be from 20 to 80, got 95"),
        (Ogden, {"E": 1e6, "nu": 0.3}, "alpha must be one number beside a modulus"),
        (Ogden, {"E": 1e6, "nu": 0.3, "alpha": [1.0, 2.0]}, "alpha must be one number beside a modulus"),
    ],
)
def test_other_tables_are_refused(law, table, rule):
    with pytest.raises(ValidationError, match=rule):
        law.model_validate(table)
