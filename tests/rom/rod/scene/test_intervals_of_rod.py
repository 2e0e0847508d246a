"""Materials along parts of the axis: identities of similarity, boundaries of elements, masses, refusals."""

from dataclasses import replace

import numpy as np
import pytest

from rom.files.checked_file import ModelError
from rom.rod.motion.lumps import lumps_of
from rom.rod.objects.shapes import Sphere
from rom.rod.rod import Rod
from rom.rod.scene.scene_of_rod import of_tables, rescaled
from rom.rod.touched_rod import AmongObjects
from rom.rod.weight import weight_of
from rom.summaries import rod_summary
from tests.rom.elements import chambered_rod, elastic_rod

LAW = elastic_rod.scene()["material"]
PULLED = np.array([20.0, 5.0])
WRENCH = np.array([[0.1, 0.2, -0.1, 1e-3, 2e-3, -1e-3]])


def law(modulus: float) -> dict:
    return LAW | {"C1": LAW["C1"] * modulus, "D1": LAW["D1"] / modulus}


def stiff(begin: float, end: float, modulus: float = 2.0, **more) -> dict:
    """A material of whole sections between two positions [m]."""
    return {"name": "stiff", "region": "section", "x": [begin, end], "material": law(modulus)} | more


def made(finger: Rod, *materials: dict, **more) -> Rod:
    return finger.assembled(elastic_rod.scene() | {"materials": list(materials)} | more)


def test_intervals_over_the_whole_axis_are_a_finger_of_that_modulus(finger):
    halves = stiff(0.0, 0.025), stiff(0.025, elastic_rod.LENGTH, name="other")
    whole, other = made(finger, *halves), finger.assembled(rescaled(finger.scene, modulus=2.0, size=1.0))
    one, two = whole.place(PULLED, WRENCH), other.place(PULLED, WRENCH)
    assert one.centres == pytest.approx(two.centres, abs=1e-7) and one.inside
    assert 2 * whole.segments[0].young_modulus == pytest.approx(other.segments[0].young_modulus, rel=1e-3)
    assert whole.segments[0].poisson == pytest.approx(other.segments[0].poisson, abs=5e-3)


def test_a_small_force_deflects_a_beam_of_two_materials(finger):
    """w = F / (E I) times the integral of (L - x)^2 / m(x) along the rubber, for moduli m E."""
    force, length, end = 1e-3, elastic_rod.LENGTH - elastic_rod.PLATE / 2, elastic_rod.LENGTH - elastic_rod.PLATE
    found = made(finger, stiff(0.012, 0.03, 3.0)).place([0.0, 0.0], [[0.0, force, 0.0, 0.0, 0.0, 0.0]])
    ends, moduli = np.array([0.0, 0.012, 0.03, end]), np.array([1.0, 3.0, 1.0])
    wanted = force / elastic_rod.BENDING * np.sum(-np.diff((length - ends) ** 3) / 3 / moduli)
    assert found.centres[0, 1] == pytest.approx(wanted, rel=1e-2)
    soft = finger.place([0.0, 0.0], [[0.0, force, 0.0, 0.0, 0.0, 0.0]]).centres[0, 1]
    assert wanted < 0.8 * soft


def test_elements_end_where_the_material_changes(finger):
    own = made(finger, stiff(0.012, 0.03), stiff(0.03, 0.033, 4.0, name="other")).pieces[0][::-1]
    ends = np.cumsum([one.length for one in own])
    assert {0.012, 0.03, 0.033} <= {round(end, 9) for end in ends}
    for one, end in zip(own, ends, strict=True):
        assert (
            one.material
            == {0: None, 1: "stiff", 2: "other"}[int(0.012 < end < 0.0301) + 2 * int(0.0301 < end < 0.0331)]
        )
    several = made(
        finger,
        stiff(0.03, 0.065),
        geometry=elastic_rod.scene()["geometry"] | {"segments": [0.05, 0.05]},
        tendons=[one | {"segment": 2} for one in elastic_rod.scene()["tendons"]],
    )
    assert [{one.material for one in own} for own in several.pieces] == [{None, "stiff"}] * 2


def test_tensions_are_those_that_the_softest_interval_was_trained_with(finger):
    with pytest.raises(ModelError, match=r"tendons.F1.tension must lie in 0 to 20 N, where .*, got \[0.0, 40.0\]"):
        made(finger, stiff(0.012, 0.03, 0.5))
    half = [one | {"tension": [0.0, 20.0]} for one in elastic_rod.scene()["tendons"]]
    soft = made(finger, stiff(0.012, 0.03, 0.5), tendons=half)
    assert soft.place([20.0, 0.0]).inside and not soft.place([20.1, 0.0]).inside


def test_rubber_of_an_interval_is_as_firm_as_its_material(finger):
    """A ball sinks into a stiff interval by less than into the rubber: the finger does not bend when squeezed."""

    def force(*materials: dict) -> float:
        model = AmongObjects(rod=made(finger, *materials), obstacles=[ball(1.0), ball(-1.0)])
        return float(model.evaluate([0.0, 0.0, 0.0, 0.0]).contact_force[0])

    soft, firm, beside = force(), force(stiff(0.012, 0.038, 3.0)), force(stiff(0.035, 0.039, 3.0))
    assert firm == pytest.approx(3 * soft, rel=0.1) and beside == pytest.approx(soft, rel=0.1)


def ball(side: float) -> Sphere:
    """A ball that presses 0.1 mm deep on a face at y, at the middle of the rubber, moved by d away from it."""
    return Sphere(
        centre=(0.025, side * 0.0099, 0.0), radius=0.005, direction=(0.0, side, 0.0), distances=(-0.001, 0.01)
    )


def test_mass_is_that_of_the_materials(finger):
    gravity = {"density": 1000.0, "plate_density": 0.0, "direction": [0.0, -1.0, 0.0]}
    heavy = made(finger, stiff(0.012, 0.03, density=3000.0), gravity=gravity)
    weight = weight_of(heavy)
    assert weight is not None
    volume = elastic_rod.SIDE**2 * (elastic_rod.LENGTH - elastic_rod.PLATE)
    more = elastic_rod.SIDE**2 * 0.018
    assert weight.masses.sum() == pytest.approx(1000.0 * volume + 2000.0 * more)
    moving = weight.masses.sum() - weight.masses[-1] / 2  # half of the last element is the clamp's
    assert lumps_of(heavy, 1000.0, 0.0).masses.sum() == pytest.approx(moving)


def test_answers_of_a_saved_finger_stay_and_tables_name_its_materials(finger, tmp_path):
    one = made(finger, stiff(0.012, 0.03, 3.0))
    text = "\n".join(part if isinstance(part, str) else part.text for part in one.tables())
    assert "clamp, interior, interior (stiff, 3 x as stiff)" in text
    assert {"material": "stiff", "modulus_over_rubber": 3.0}.items() <= rod_summary(one)["segments"][0][2].items()
    one.save(tmp_path / "finger.h5")
    assert np.array_equal(Rod.load(tmp_path / "finger.h5").place(PULLED).centres, one.place(PULLED).centres)


@pytest.mark.parametrize(
    ("materials", "rule"),
    [
        ([stiff(0.005, 0.03)], r"geometry.segments.0: material must begin and end from 0.01 to 0.039 m .*, got 0.005"),
        ([stiff(0.02, 0.045)], r"between its clamp and plate pieces, got 0.045"),
        (
            [stiff(0.02, 0.03), stiff(0.025, 0.035, name="b")],
            r"materials.b.x must begin beyond stiff, 0.03 m, got 0.025",
        ),
        ([stiff(0.02, 0.03) | {"material": LAW | {"C1": 2 * LAW["C1"]}}], r"materials.stiff: material.D1 .* must be"),
        ([stiff(0.02, 0.03) | {"material": {"law": "yeoh"}}], "materials.stiff: material.law must be neo-hookean"),
        (
            [stiff(0.02, 0.03) | {"region": "rectangle", "centre": [0.0, 0.0], "size": [0.002, 0.002]}],
            r"materials.stiff.x must be left out .* unless the region is 'section': .*, got .* of 'rectangle'",
        ),
    ],
)
def test_intervals_that_elements_cannot_make_are_refused(finger, materials, rule):
    with pytest.raises(ModelError, match=rule):
        made(finger, *materials)


def test_elements_of_several_materials_have_no_intervals(rod_elements):
    core = {"name": "core", "region": "rectangle", "centre": [0.0, 0.0], "size": [0.002, 0.002], "material": law(50.0)}
    trained = replace(rod_elements, scene=elastic_rod.scene() | {"materials": [core]})
    with pytest.raises(ModelError, match=r"materials.stiff.x must be left out where elements are of several materials"):
        Rod(elements=trained, scene=of_tables(elastic_rod.scene() | {"materials": [core, stiff(0.02, 0.03)]}))


def test_intervals_of_a_rod_with_chambers_are_refused(chambered):
    scene = chambered_rod.scene()
    part = stiff(0.02, 0.03) | {"material": scene["material"]}
    with pytest.raises(ModelError, match=r"materials.stiff.x must be left out of a rod with chambers, .* with p1"):
        chambered.assembled(scene | {"materials": [part]})
