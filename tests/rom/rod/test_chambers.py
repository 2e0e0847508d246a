"""A finger of elements with chambers: pressures beside tensions, growths of volume beside shortenings."""

import re

import numpy as np
import pytest

from rom.elements.march import march
from rom.files.checked_file import ModelError
from rom.rod.motion.moving_finger import MovingFinger
from rom.rod.objects.shapes import Plane
from rom.rod.rod import Rod
from rom.rod.touched_segment import TouchedSegment
from rom.rod.weight import weight_of
from tests.rom.elements import chambered_rod as one

FREE = np.array([4.0, 4e5, 1e5])


def plane(height: float) -> Plane:
    """The plane y = height + d."""
    return Plane(centre=(0.0, height, 0.0), direction=(0.0, 1.0, 0.0), normal=(0.0, -1.0, 0.0), distances=(-0.01, 0.01))


def test_held_out_states_are_predicted_with_their_strokes(chambered):
    held_out = one.states(8, 77)
    found = march(chambered.segments[0].elements, held_out.inputs[:, :3], held_out.inputs[:, 3:])
    left_out = chambered.elements.provenance["left_out"]
    off = np.linalg.norm(found.plate[0] - held_out.plate.places, axis=1)
    assert np.quantile(off, 0.95) < 2 * left_out["place_m"]["p95"] < 1e-4
    strokes, exact = found.shortenings, held_out.shortenings[:, -1]
    assert (np.abs(strokes - exact).max(axis=0) < 5e-3 * np.abs(exact).max(axis=0)).all()
    assert np.abs(strokes - exact)[:, 1:].max() < 5 * left_out["growth_m3"]["p95"]


def test_mirrors_exchange_chambers(chambered):
    """The half y < 0 and its chamber against the other one: exact, as samples have images."""
    up, down = (chambered.place([4.0, *pressures]) for pressures in ([4e5, 1e5], [1e5, 4e5]))
    assert up.centres[0, 1] > 1e-3  # a chamber bends the finger away from it
    assert down.centres == pytest.approx(up.centres * [1, -1, 1], abs=1e-9)
    assert chambered.growth([4.0, 1e5, 4e5]) == pytest.approx(chambered.growth(FREE)[::-1], rel=1e-6)


def test_work_has_a_potential_in_free_states(chambered):
    """d growth / dF = d shortening / dp, and a pressure enlarges its own chamber."""
    model = TouchedSegment(rod=chambered, obstacle=plane(1.0))
    report = model.report([*FREE, np.inf])
    by = np.concatenate([report.shortening_jacobian, report.growth_jacobian])[:, :3]
    scale = np.sqrt(np.outer(np.diag(by), np.diag(by)))
    assert (np.diag(by) > 0).all() and (np.abs(by - by.T) < 2e-2 * scale).all()
    assert report.growths == pytest.approx(chambered.growth(FREE)) and report.growth_error > 0
    assert report.shortenings == pytest.approx(chambered.shortening(FREE))
    answer = model.evaluate([*FREE, np.inf])
    assert answer.growths == pytest.approx(report.growths) and answer.as_json(model.names[:3])["growths_m3"].keys() == {
        "p1",
        "p2",
    }


@pytest.mark.parametrize(
    ("segments", "height", "pulled"), [(1, 0.006, [1.0, 4.5e5, 10.0]), (2, 0.010, [1.0, *[3e5, 10.0] * 2])]
)
def test_derivatives_by_all_pressures_are_differences_in_contact(chambered, segments, height, pulled):
    rod, size = chambered if segments == 1 else chambered.assembled(one.two_segments()), 2 + 2 * segments
    model, point = TouchedSegment(rod=rod, obstacle=plane(height)), np.array([*pulled, 0.0])
    out, jacobian = model.value_and_jacobian(point)
    assert out[3] > 1e-3
    for k, step in enumerate([1e-4] + [5.0] * (size - 2)):
        change = np.eye(size)[k] * step
        ends = model.outputs(np.array([point - change, point + change]))
        wanted = jacobian[:, k]
        assert (ends[1] - ends[0]) / (2 * step) == pytest.approx(wanted, abs=1e-4 * np.abs(wanted).max())
    assert (jacobian[3, 1 : size - 1 : 2] > 0).all()


def test_a_similar_finger_does_the_same_under_pressures_by_its_modulus(chambered):
    size, modulus = 2.0, 0.1
    force, scene = modulus * size**2, one.scene()
    material = scene["material"]
    scene |= {"material": material | {"C1": material["C1"] * modulus, "D1": material["D1"] / modulus}}
    scene["geometry"] = {"side": 0.010 * size, "segments": [0.050 * size], "plate": 0.001 * size, "channel": None}
    scene["tendons"] = [tendon | {"tension": [0.0, 10.0 * force]} for tendon in scene["tendons"]]
    scene["chambers"] = [
        chamber
        | {key: [size * part for part in chamber[key]] for key in ("centre", "size", "x")}
        | {"pressure": [0.0, modulus * one.HIGHEST]}
        for chamber in scene["chambers"]
    ]
    similar, loads = chambered.assembled(scene), FREE * [force, modulus, modulus]
    wrench = np.array([[0.1, 0.2, -0.1, 2e-3, 1e-3, -2e-3]])
    here, there = chambered.place(FREE, wrench), similar.place(loads, wrench * np.repeat([force, force * size], 3))
    assert there.centres == pytest.approx(size * here.centres, rel=1e-12) and there.inside and here.inside
    strokes = chambered.strokes(FREE), similar.strokes(loads)
    assert strokes[1] == pytest.approx(strokes[0] * [size, size**3, size**3], rel=1e-12)
    assert similar.segments[0].bulges == pytest.approx(size * chambered.segments[0].bulges, rel=1e-12)
    assert [end.upper for end in similar.parameters] == [10 * force, 5e4, 5e4]


def test_a_file_holds_pressures(chambered, tmp_path):
    chambered.save(tmp_path / "finger.h5")
    again = Rod.load(tmp_path / "finger.h5")
    assert [(each.name, each.unit) for each in again.parameters] == [("F1", "N"), ("p1", "Pa"), ("p2", "Pa")]
    assert np.array_equal(again.place(FREE).centres, chambered.place(FREE).centres)
    text = "\n".join(part if isinstance(part, str) else part.text for part in again.tables())
    assert re.search(r"p1 +0 +500 +kPa", text) and re.search(r"F1 +0 +10 +N", text)


def changed(k: int = 0, **changes) -> dict:
    scene = one.scene()
    scene["chambers"][k] |= changes
    return scene


@pytest.mark.parametrize(
    ("scene", "rule"),
    [
        (
            changed(centre=[-0.003, 0.0]),
            r"chambers.p1.centre must be that of a chamber of the elements, one of .*-0.003",
        ),
        (changed(size=[0.003, 0.005]), r"chambers.p1.size must be \[0.003, 0.006\] m, got \[0.003, 0.005\]"),
        (
            changed(x=[0.004, 0.047]),
            r"chambers.p1.x, distances from the segment's clamp and plate, must be \[0.002, 0.002",
        ),
        (changed(pressure=[0.0, 6e5]), "chambers.p1.pressure must lie in 0 to 500000 Pa, where the elements were"),
        (changed(name="F1"), "tendons and chambers must have names of their own, got F1, F1, p2"),
        (changed(region="bore"), "chambers.p1.region must be 'rectangle' in a rod's scene, got 'bore'"),
        (one.scene() | {"chambers": one.scene()["chambers"][:1]}, r"each once \(2 of them\), got p1"),
        (one.scene() | {"chambers": []}, r"each once \(2 of them\), got none"),
    ],
)
def test_chambers_that_the_elements_do_not_have_are_refused(chambered, scene, rule):
    with pytest.raises(ModelError, match=rule):
        chambered.assembled(scene)


def test_every_segment_bends_by_its_own_chambers(chambered):
    """Without a wrench, the second plate seen from the first is that of one segment under its own loads."""
    finger, loads = chambered.assembled(one.two_segments()), np.array([4.0, 4e5, 1e5, 0.5e5, 3e5])
    found, half = finger.place(loads), finger.half_lengths[0]
    for k, own in enumerate(([0, 1, 2], [0, 3, 4])):
        alone = chambered.place(loads[own])
        before = (np.zeros(3), np.eye(3)) if k == 0 else (found.centres[0], found.rotations[0])
        begin = before[0] + k * half * before[1][:, 0]
        assert found.centres[k] == pytest.approx(begin + before[1] @ alone.centres[0], abs=1e-12)
        assert found.rotations[k] == pytest.approx(before[1] @ alone.rotations[0], abs=1e-12)
        assert finger.growth(loads)[2 * k : 2 * k + 2] == pytest.approx(chambered.growth(loads[own]), rel=1e-9)
    assert found.inside and finger.names == ["F1", "p1", "p2", "p3", "p4"]
    assert finger.shortening(loads) == pytest.approx(
        sum(chambered.shortening(loads[own]) for own in ([0, 1, 2], [0, 3, 4]))
    )


def test_every_segment_has_the_chambers_of_the_elements(chambered):
    scene = one.two_segments()
    with pytest.raises(ModelError, match=r"chambers in segment 2 must be .*, each once \(2 of them\), got p3"):
        chambered.assembled(scene | {"chambers": scene["chambers"][:3]})
    across = scene["chambers"][0] | {"x": [0.002, 0.097]}
    with pytest.raises(
        ModelError, match=r"chambers.p1.x must lie in the rubber of one segment, .*, got \[0.002, 0.097"
    ):
        chambered.assembled(scene | {"chambers": [across]})
    with pytest.raises(ModelError, match=r"geometry.taper must be left out with chambers, got \[0.9\]"):
        chambered.assembled(one.scene() | {"geometry": one.scene()["geometry"] | {"taper": [0.9]}})


def test_a_longer_segment_bulges_alike(chambered):
    """Growth per length of chamber is that of the interior elements, so a face rises as high over a longer chamber."""
    scene = one.scene()
    scene["geometry"] |= {"segments": [0.080]}
    scene["chambers"] = [chamber | {"x": [0.002, 0.077]} for chamber in scene["chambers"]]
    longer = chambered.assembled(scene).segments[0].bulges
    assert longer == pytest.approx(chambered.segments[0].bulges, rel=0.05)


def test_what_comes_near_a_bulging_face_is_marked(chambered):
    """Pressure in the upper chamber lifts the face at +y: a plane within its height is not inside, below it is."""
    (height,) = chambered.segments[0].bulges[2, :1]
    assert height > 1e-5 and (chambered.segments[0].bulges[0] == 0).all()
    assert chambered.segments[0].bulges[1] == pytest.approx([-height, 0.0], rel=1e-6)

    def at(d: float, pressures: tuple[float, float]):
        return TouchedSegment(rod=chambered, obstacle=plane(0.005)).evaluate([0.0, *pressures, d])

    both = one.HIGHEST, one.HIGHEST  # the finger stays straight
    touch = at(np.inf, both).touch_distance
    assert not at(touch + 0.5 * height, both).inside and at(touch + 1.5 * height, both).inside
    assert at(touch + 1.5 * height, both).error["touch_distance"] > 0.9 * height
    low = at(touch + 0.5 * height, (0.0, 0.0))
    assert low.inside and low.error["touch_distance"] < 0.5 * height


def test_chambers_have_no_weight(chambered):
    """The mass of a rod is that of its rubber: the section's less the chambers', over their span."""
    gravity = {"density": 1000.0, "plate_density": 0.0, "direction": [0.0, -1.0, 0.0]}
    heavy = chambered.assembled(one.scene() | {"gravity": gravity})
    volume = 0.010**2 * (0.050 - 0.001) - 2 * one.AREA * (one.X[1] - one.X[0])
    assert weight_of(heavy).masses.sum() == pytest.approx(1000.0 * volume, rel=1e-9)
    assert heavy.place([0.0, 0.0, 0.0]).centres[0, 1] < -1e-7
    two = chambered.assembled(one.two_segments(gravity=gravity))
    assert weight_of(two).masses == pytest.approx(np.tile(weight_of(heavy).masses, 2), rel=1e-9)
    with pytest.raises(ModelError, match=r"gravity must be left out with chambers on one side: .* got chambers p1"):
        chambered.assembled(one.scene() | {"gravity": gravity, "chambers": one.scene()["chambers"][:1]})


def test_what_is_for_tendons_alone_refuses_chambers(chambered):
    model = TouchedSegment(rod=chambered, obstacle=plane(1.0))
    with pytest.raises(ModelError, match=r"motion must be of a finger with tendons alone, got one with 2 chambers"):
        MovingFinger(model, [0.0, 0.0, 0.0, np.inf], density=1000.0)
