"""Nearly incompressible rubber: Newton's iterations do not grow with the bulk modulus, and the answer is right."""

from functools import cache

import numpy as np
import pytest

from fingerfem import FingerModel
from fingerfem.output.cell_fields import cell_fields
from fingerfem.scene.laws import neo_hookean_from
from fingerfem.scene.scene import Scene

C1 = 8.3e3  # [Pa]: of silicone
POISSON = [0.499, 0.4999, 0.499995]  # the last is that of the published bulk modulus
PULLS = [1.0, 1.5]  # [N]


@cache
def silicone(poisson: float, cells: tuple[int, int] = (20, 5), order: int = 1, pressed: bool = False) -> FingerModel:
    """A finger of 20 x 20 x 100 mm of some Poisson's ratio."""
    law = neo_hookean_from(4 * (1 + poisson) * C1, poisson)
    table = {
        "name": "silicone",
        "geometry": {"side": 0.020, "segments": [0.100], "plate": 0.002},
        "material": {"law": "neo-hookean", "C1": law.C1, "D1": law.D1},
        "tendons": [{"name": "F1", "offset": [0.008, 0.0], "segment": 1, "tension": [0.0, 2.0]}],
        "mesh": {"cells": list(cells), "order": order},
    }
    if pressed:
        table["obstacle"] = {"distance": [0.001, 0.080], "method": "penalty"}
    return FingerModel(Scene.model_validate(table))


@cache
def bent(poisson: float, pull: float):
    return silicone(poisson).solve([pull], sensitivities=False)


@pytest.mark.parametrize("pull", PULLS)
@pytest.mark.parametrize("poisson", [POISSON[-1], *(pytest.param(one, marks=pytest.mark.long) for one in POISSON[:-1])])
def test_iterations_do_not_grow_with_the_bulk_modulus(poisson, pull):
    """At most twice those of Poisson's ratio 0.49, whose bulk modulus is up to 2000 times smaller."""
    assert bent(poisson, pull).newton_iterations <= 2 * bent(0.49, pull).newton_iterations <= 40


@pytest.mark.long
@pytest.mark.parametrize("pull", PULLS)
def test_it_takes_no_more_iterations_than_the_rubber_on_which_presets_measure_their_cost(pull):
    """An iteration of the mixed form costs as much as another."""
    most = max(bent(poisson, pull).newton_iterations for poisson in POISSON)
    assert most <= 1.25 * bent(0.3, pull).newton_iterations


@pytest.mark.parametrize("pull", PULLS)
def test_the_bending_converges_as_the_bulk_modulus_grows(pull):
    """The distance of the tip's displacement from the incompressible limit falls as 1 - 2 nu."""
    limit = bent(0.499995, pull).tip[1]
    away = [abs(bent(poisson, pull).tip[1] - limit) for poisson in (0.49, 0.499, 0.4999)]
    assert away[0] / away[1] == pytest.approx(10, rel=0.1)
    assert away[1] / away[2] == pytest.approx(10, rel=0.1)


@pytest.mark.parametrize("poisson", [0.49, 0.499995])
def test_the_prediction_of_the_pressure_changes_iterations_and_not_the_answer(poisson):
    """Newton's plain method, which extrapolates no stress, leaves the answer where it is."""
    model, state = silicone(poisson), bent(poisson, 1.0)
    model.take(state)
    model.problem.displacement[:] *= 1 + 1e-6
    model.continuation.newton.solve("plain")
    assert np.abs(model.problem.displacement - state.displacement).max() < 1e-8 * 0.1


def test_the_volume_ratio_reported_is_that_of_the_pressure():
    """J - 1 = p D1 / 2 there; between the points of the pressure the displacement's own J is another."""
    state = bent(0.499995, 1.5)
    assert 1 - 1e-4 < state.smallest_volume_ratio < 1
    model = silicone(0.499995)
    model.take(state)
    assert model.problem.limits.smallest_of_cells() < 0.9
    compressible = bent(0.3, 1.0)
    silicone(0.3).take(compressible)
    assert compressible.smallest_volume_ratio == silicone(0.3).problem.limits.smallest_of_cells()


@pytest.mark.long
@pytest.mark.parametrize("poisson", [0.49, 0.499995])
def test_stresses_are_those_of_the_pressure_and_not_of_the_displacements_volume(poisson):
    """Linear cells have their pressure at the midpoint, where stresses are reported, quadratic ones around it.

    The two meshes differ by a fifth of the largest value, in the cells at the clamp's edge.
    """
    fields = []
    for order in (1, 2):
        model = silicone(poisson, (20, 5), order)
        model.solve([1.0], sensitivities=False)
        fields.append(cell_fields(model))
    for name, at_rest in (("S11", 0.0), ("J", 1.0)):
        largest = np.nanmax(np.abs(fields[0][name] - at_rest))
        assert np.nanmax(np.abs(fields[1][name] - fields[0][name])) < 0.3 * largest


@pytest.mark.long
@pytest.mark.parametrize(("pull", "distance"), [(1.0, 0.010), (1.5, 0.020)])
def test_bent_and_pressed_it_neither_locks_nor_diverges(pull, distance):
    """At Poisson's ratio 0.4999 against quadratic cells, twice as fine."""
    coarse, fine = (
        silicone(0.4999, *mesh, pressed=True).solve([pull], distance, sensitivities=False)
        for mesh in (((20, 5), 1), ((20, 5), 2))
    )
    assert coarse.contact_force == pytest.approx(fine.contact_force, rel=0.015)
    assert coarse.tip == pytest.approx(fine.tip, abs=0.005 * 0.1)
    assert coarse.clamp_reaction[1] == pytest.approx(coarse.contact_force, rel=1e-8)
    assert coarse.newton_iterations <= 30
