"""Another finite element code, FElupe, finds the same states on the same mesh: the short form of docs/peers.md."""

import numpy as np
import pytest

from fingerfem import FingerModel
from studies.peers.felupe.comparison import (
    FELUPE,
    MOONEY_RIVLIN,
    NEO_HOOKEAN,
    TIGHT,
    ask_felupe,
    compare,
    described,
    scene_of,
)

pytestmark = pytest.mark.skipif(
    not (FELUPE / "felupe").exists(), reason="FElupe is not in its folder: make out/peers/felupe/ready"
)
MESH = [10, 5], 1
FREE, TOUCHING = ([40.0, 20.0], None), ([40.0, 20.0], 0.012)


@pytest.mark.parametrize("method", ["penalty", pytest.param("nitsche", marks=pytest.mark.long)])
def test_felupe_finds_the_same_displacement_and_contact_force(method, tmp_path):
    free, touching = compare(scene_of("one_segment", NEO_HOOKEAN, MESH, method), (FREE, TOUCHING), tmp_path)
    assert free["failed"] is None and touching["failed"] is None
    assert free["displacement_difference"] < 1e-10
    assert touching["displacement_difference"] < 1e-10
    assert touching["contact_force"] > 1.0 and touching["contact_force_difference"] < 1e-6


@pytest.mark.long
def test_felupe_differentiates_an_energy_to_the_same_displacement(tmp_path):
    (free,) = compare(scene_of("one_segment", MOONEY_RIVLIN, MESH), (FREE,), tmp_path)
    assert free["failed"] is None and free["displacement_difference"] < 1e-10


def test_a_modulus_that_is_off_by_a_millionth_is_seen(tmp_path):
    """What is compared is the physics, not a number that both codes are given."""
    model = FingerModel(scene_of("one_segment", NEO_HOOKEAN, MESH))
    model.continuation.newton.options = TIGHT
    ours = model.solve(FREE[0], sensitivities=False).displacement.reshape(-1, 3)
    arrays, numbers = described(model)
    numbers["law"]["C1"] *= 1 + 1e-6
    state = {"tensions": FREE[0], "distance": None}
    theirs, _ = ask_felupe(arrays, {"scene": numbers, "states": [state]}, tmp_path)
    assert 1e-8 < np.abs(theirs[0] - ours).max() / np.abs(ours).max() < 1e-5
