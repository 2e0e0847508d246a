"""Fits recover known constants and are stable, and one is chosen by data that it did not see."""

import numpy as np
import pytest
from material_fit.synthetic import KNOWN, MODES, measured
from scipy.optimize import minimize

from fingerfem.material_fit.fit import CONSTANTS, LAWS, compare, fitted
from fingerfem.material_fit.linear import least_squares_in_cone, unit_laws, work
from fingerfem.material_fit.measurements import Measurement
from fingerfem.material_fit.points import points_of
from fingerfem.material_fit.stresses import nominal_stress
from fingerfem.scene.laws import REGISTERED, MooneyRivlin, Yeoh
from fingerfem.scene.laws.stability import first_loss

STIFFENING = Yeoh(C1=1e5, C2=2e4, C3=5e3, D1=1e-8)  # of which Mooney's and Rivlin's best law has a negative constant


def constants(law, name: str) -> list[float]:
    """In the order of powers, for Ogden's law."""
    if name == "ogden":
        return [value for pair in sorted(zip(law.alpha, law.mu, strict=True)) for value in pair]
    return [getattr(law, one) for one in CONSTANTS[name]]


@pytest.mark.parametrize("modes", [MODES, MODES[:1]], ids=["three tests", "uniaxial"])
@pytest.mark.parametrize("name", KNOWN)
def test_without_noise_the_constants_are_recovered(name, modes):
    found = compare(measured(KNOWN[name], modes), [name]).chosen
    assert constants(found.law, name) == pytest.approx(constants(KNOWN[name], name), rel=1e-6)
    assert found.errors.largest < 1e-6 and found.left_out.largest < 1e-6 and not found.is_constrained


@pytest.mark.parametrize("name", KNOWN)
def test_with_noise_the_constants_are_recovered_within_their_standard_errors(name):
    law, seeds = KNOWN[name], range(24)
    tables = [fitted(name, points_of(measured(law, noise=0.01, seed=seed)), 2, None) for seed in seeds]
    found = np.array([constants(REGISTERED[name].model_construct(**one), name) for one in tables])
    error = found.mean(axis=0) - constants(law, name)
    bias = 0.02 * np.abs(constants(law, name)) if name == "ogden" else 0.0  # of a law that is not linear
    assert (np.abs(error) <= 4 * found.std(axis=0) / np.sqrt(len(seeds)) + bias).all()
    moduli = [REGISTERED[name].model_construct(**one).shear_modulus for one in tables]
    assert moduli == pytest.approx(np.full(len(seeds), law.shear_modulus), rel=0.03)


@pytest.mark.parametrize("name", KNOWN)
def test_the_law_that_made_the_data_is_chosen_and_of_two_that_fit_the_one_of_fewer_constants(name):
    found = compare(measured(KNOWN[name], noise=0.002))
    assert found.chosen.name == name and [one.name for one in found.fits] == list(LAWS)
    assert found.chosen.left_out.rms == pytest.approx(0.002, rel=0.2)


def test_poisson_s_ratio_and_the_range_of_the_data_are_those_of_the_law():
    for one in compare(measured(KNOWN["mooney-rivlin"]), nu=0.495).fits:
        assert one.law.poisson == pytest.approx(0.495, rel=1e-7) and one.law.stretches == [0.25, 2.0]


def test_a_law_that_loses_stability_within_the_data_is_fitted_among_the_stable_ones():
    measurements = measured(STIFFENING, ["uniaxial"])
    found = compare(measurements, ["mooney-rivlin"]).chosen
    free = MooneyRivlin.model_construct(**fitted("mooney-rivlin", points_of(measurements), 2, None), D1=found.law.D1)
    assert first_loss(free, (0.7071, 2.0)) is not None and first_loss(found.law, (0.7071, 2.0)) is None
    assert found.is_constrained and found.law.C01 < 0
    assert found.loss is not None and not 0.7071 < found.loss[1] < 1.19  # it is lost beyond the data
    simple = compare(measurements, ["neo-hookean"]).chosen
    assert found.errors.rms < simple.errors.rms


def test_least_squares_in_a_cone_are_those_of_another_solver():
    random = np.random.default_rng(3)
    for _ in range(20):
        A, b, G = random.normal(size=(30, 3)), random.normal(size=30), random.normal(size=(12, 3))
        G[:, 0] = np.abs(G[:, 0])  # the cone has an inside
        found = least_squares_in_cone(A, b, G)
        other = minimize(
            lambda c, A=A, b=b: np.sum((A @ c - b) ** 2),
            np.zeros(3),
            constraints={"type": "ineq", "fun": lambda c, G=G: G @ c},
            tol=1e-14,
        )
        assert (G @ found >= -1e-9).all() and np.sum((A @ found - b) ** 2) <= other.fun * (1 + 1e-7)


def test_the_work_of_a_change_of_strain_is_positive_where_a_law_is_stable_and_not_beyond():
    units = unit_laws(Yeoh, ("C1", "C2", "C3"))
    law = Yeoh.model_construct(law="yeoh", C1=1e5, C2=-2e4, C3=0.0, D1=1e-12)
    mode, stretch = first_loss(law, (0.3, 3.0))
    stable, unstable = ((stretch**k, stretch ** (-2 * k)) for k in (0.95, 1.05))
    assert mode == "equibiaxial" and stretch < 1  # the same states as uniaxial tension
    assert (work(units, stable) @ [1e5, -2e4, 0.0]).min() > 0 > (work(units, unstable) @ [1e5, -2e4, 0.0]).min()


def test_dense_data_and_tests_of_many_points_do_not_dominate():
    few = measured(STIFFENING, ["uniaxial", "planar"], count=40)
    dense = np.sort(np.concatenate([np.linspace(1.0, 1.2, 4000)[1:], few[0].stretch]))
    many = Measurement(mode="uniaxial", stretch=dense, stress=nominal_stress(STIFFENING, "uniaxial", dense))
    moduli = [compare([one, few[1]], ["neo-hookean"]).chosen.law.shear_modulus for one in (few[0], many)]
    assert moduli[1] == pytest.approx(moduli[0], rel=0.02)
    weight = points_of([many, few[1]]).weight
    assert weight[: len(dense)].sum() == pytest.approx(0.5) and weight[len(dense) :].sum() == pytest.approx(0.5)


def test_points_left_out_are_not_seen_by_their_fit():
    """A fold's stresses are raised: its own predictions stay, and its error is what was added."""
    plain = measured(KNOWN["neo-hookean"], ["uniaxial"])[0]
    fold = points_of([plain]).fold
    assert [len(np.unique(np.flatnonzero(np.diff(fold == k)))) for k in range(3)] == [
        5,
        6,
        5,
    ]  # blocks of three, contiguous
    raised = Measurement(mode="uniaxial", stretch=plain.stretch, stress=plain.stress + 0.1 * plain.peak * (fold == 1))
    found = compare([raised], ["neo-hookean"]).chosen
    points = points_of([raised])
    own = fitted("neo-hookean", points.where(points.fold != 1), 2, None)
    assert own["C1"] == pytest.approx(1e5, rel=1e-6)
    assert found.left_out.largest >= 0.1 * plain.peak / raised.peak * (1 - 1e-6)


def test_data_beyond_a_law_s_own_stretches_leave_it_out():
    stretch = np.linspace(1.1, 7.0, 60)
    found = compare(
        [Measurement(mode="uniaxial", stretch=stretch, stress=nominal_stress(STIFFENING, "uniaxial", stretch))]
    )
    ogden = found.fits[-1]
    assert ogden.name == "ogden" and ogden.law is None and found.chosen.name == "yeoh"
    assert ogden.reason == "data must be at principal stretches from 0.2 to 5, got 0.378 to 7; fit fewer by --to"


def test_a_gel_that_scenes_do_not_accept_has_no_law():
    found = compare(
        measured(Yeoh.model_construct(law="yeoh", C1=5.0, C2=0.0, C3=0.0, D1=1e-4)), ["neo-hookean", "yeoh"]
    )
    assert found.chosen is None and [one.law for one in found.fits] == [None, None]
    assert found.fits[0].reason.startswith("C1 must be at least 100 Pa, got 5.0")


@pytest.mark.parametrize(
    ("asked", "rule"),
    [
        ({"names": ["gent"]}, "law must be one of neo-hookean, mooney-rivlin, yeoh, ogden, got gent"),
        ({"nu": 0.4}, "nu must be from 0.49 to 0.49999, .* got 0.4"),
        ({"nu": float("nan")}, "nu must be from 0.49 to 0.49999, .* got nan"),
    ],
)
def test_other_requests_are_refused(asked, rule):
    with pytest.raises(ValueError, match=rule):
        compare(measured(KNOWN["yeoh"]), **asked)


def test_three_terms_of_ogden_fit_no_worse_than_two():
    measurements = measured(STIFFENING, noise=0.003)
    errors = [compare(measurements, ["ogden"], terms=terms).chosen.errors.rms for terms in (1, 2, 3)]
    assert errors[0] >= errors[1] * (1 - 1e-9) and errors[1] >= errors[2] * (1 - 1e-6)
