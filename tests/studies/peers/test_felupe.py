"""Another finite element code, FElupe, finds the same states on the same mesh: the short form of docs/peers.md."""

import pytest

from studies.peers.felupe.comparison import FELUPE, MOONEY_RIVLIN, NEO_HOOKEAN, WEIGHT, YEOH, compare, scene_of

pytestmark = pytest.mark.skipif(
    not (FELUPE / "felupe").exists(), reason="FElupe is not in its folder: make out/peers/felupe/ready"
)
MESH = [10, 5], 1
SILICONE = {"law": "yeoh", "C1": 98873.17, "C2": 4505.4957, "C3": 1390.5689, "D1": 2.0241429e-08}
HEAVY = {"density": 1070.0, "direction": [0.3, -0.5, 0.8]}  # aside, too: the finger is whole
FREE, TOUCHING = ([40.0, 20.0], None), ([40.0, 20.0], 0.012)


def test_felupe_finds_the_same_displacement_and_contact_force(tmp_path):
    found = compare(scene_of("one_segment", NEO_HOOKEAN, MESH), (FREE, TOUCHING), tmp_path)
    assert found["displacement"] < 1e-10 and found["contact_force"] < 1e-6


@pytest.mark.long
def test_felupe_differentiates_an_energy_to_the_same_displacement(tmp_path):
    found = compare(scene_of("one_segment", MOONEY_RIVLIN, MESH), (FREE,), tmp_path)
    assert found["displacement"] < 1e-10 and found["contact_force"] is None


@pytest.mark.parametrize("mesh", [MESH, pytest.param(([6, 5], 2), marks=pytest.mark.long)])
def test_felupe_finds_the_same_states_of_heavy_and_nearly_incompressible_rubber_of_yeoh(tmp_path, mesh):
    """Its pressure at fewer points, as the mixed form has it."""
    found = compare(scene_of("one_segment", YEOH, mesh, gravity=WEIGHT), (FREE, TOUCHING), tmp_path)
    assert found["displacement"] < 1e-8 and found["contact_force"] < 1e-6


def test_felupe_finds_the_same_states_under_pressure_in_chambers(tmp_path):
    """With weight, in the mixed form: free, and pressed on a plane by pressure and tension."""
    scene = scene_of("two_chambers", SILICONE, ([12, 9], 1), gravity=HEAVY, obstacle={"distance": [0.0005, 0.02]})
    states = ([5.0, 5e4, 1e4], None), ([0.0, 2e4, 4e4], None), ([2.0, 4e4, 0.0], 0.002)
    found = compare(scene, states, tmp_path)
    assert found["displacement"] < 1e-8 and found["contact_force"] < 1e-6


def test_weight_that_is_off_by_a_thousandth_is_seen(tmp_path):
    scene = scene_of("one_segment", NEO_HOOKEAN, MESH, gravity=WEIGHT)
    found = compare(scene, (FREE,), tmp_path, {"densities": [1071.07, 7857.85]})
    assert 1e-8 < found["displacement"] < 1e-3


def test_a_modulus_that_is_off_by_a_millionth_is_seen(tmp_path):
    """The comparison is of the physics, not of a number that both codes are given."""
    wrong = {"law": NEO_HOOKEAN | {"C1": NEO_HOOKEAN["C1"] * (1 + 1e-6)}}
    found = compare(scene_of("one_segment", NEO_HOOKEAN, MESH), (FREE,), tmp_path, wrong)
    assert 1e-8 < found["displacement"] < 1e-5
