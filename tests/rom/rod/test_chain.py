"""Chains of maps against a rod that is marched through all its segments at once."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from control import Finger
from rom.checked_file import ModelError
from rom.rod.objects import Object, Plane, Sphere, box, facing_plane
from rom.rod.rod import Chain
from rom.rod.touched_segment import TouchedSegment
from tests.rom.rod import kirchhoff as rod

TENSIONS = np.array([6.0, 3.0])
WRENCHES = np.array([[0.1, -0.2, 0.15, 2e-4, -3e-4, 2e-4], [-0.1, 0.12, 0.05, 3e-4, 1e-4, -2e-4]])


def whole(tensions: np.ndarray, wrenches: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Centres and rotations of two plates of a rod, the tip's wrench carried on to the first plate by statics."""
    tip = rod.poses(np.concatenate([tensions, wrenches[1]])[None])[0]
    turned = Rotation.from_quat(tip[[4, 5, 6, 3]]).as_matrix()
    arm = -turned @ tip[:3] + np.array([rod.PLATE / 2, 0, 0])
    force = turned @ wrenches[1, :3]
    borne = wrenches[0] + np.concatenate([force, turned @ wrenches[1, 3:] + np.cross(arm, force)])
    base = rod.poses(np.concatenate([tensions, borne])[None])[0]
    first = Rotation.from_quat(base[[4, 5, 6, 3]]).as_matrix()
    centre = -first @ base[:3]
    return [(centre, first), (centre + first @ arm, first @ turned)]


def test_two_segments_stand_where_the_rod_does(segment):
    placed = Chain([segment, segment]).place(TENSIONS, WRENCHES)
    assert placed.inside
    for centre, rotation, (there, turned) in zip(
        placed.centres, placed.rotations, whole(TENSIONS, WRENCHES), strict=True
    ):
        assert centre == pytest.approx(there, abs=2e-5)
        assert rotation == pytest.approx(turned, abs=5e-4)


def test_a_chain_of_one_is_its_segment(segment):
    alone, chain = segment.place([*TENSIONS, *WRENCHES[0]]), Chain([segment]).place(TENSIONS, WRENCHES[:1])
    assert chain.centres[0] == pytest.approx(alone.centre) and chain.rotations[0] == pytest.approx(alone.rotation)
    assert chain.motions[0] == pytest.approx(alone.motion)


def test_motions_are_those_of_differences(segment):
    chain = Chain([segment, segment, segment])
    wrenches = np.vstack([WRENCHES, 0.3 * WRENCHES[:1]])
    placed = chain.place(TENSIONS, wrenches)
    for k, h in enumerate([1e-3] * 2 + ([1e-4] * 3 + [1e-6] * 3) * 3):
        unit = h * np.eye(20)[k]
        before, after = (chain.place(TENSIONS + s * unit[:2], wrenches + s * unit[2:].reshape(3, 6)) for s in (-1, 1))
        for plate in range(3):
            turned = placed.rotations[plate]
            spin = turned.T @ (after.rotations[plate] - before.rotations[plate]) / (2 * h)
            moved = turned.T @ (after.centres[plate] - before.centres[plate]) / (2 * h)
            found = np.concatenate([moved, [spin[2, 1], spin[0, 2], spin[1, 0]]])
            assert placed.motions[plate, :, k] == pytest.approx(found, rel=1e-4, abs=1e-5 * np.abs(found).max())


def test_what_is_no_chain_is_refused(segment):
    with pytest.raises(ModelError, match="at least one"):
        Chain([])
    with pytest.raises(ModelError, match="inputs must be 2 tensions"):
        Chain([segment]).place([1.0])


HALF = np.array([rod.PLATE, rod.SIDE, rod.SIDE]) / 2
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * HALF
WHERE = {"direction": (0.0, 1.0, 0.0), "distances": (0.0, 0.1)}
# What touches, and which plates.
OBJECTS = {"plane": {1}, "ball at the middle": {0}, "plane along both": {0, 1}, "box": {1}}


def pressed(segment, name: str) -> tuple[TouchedSegment, np.ndarray]:
    """A finger of two segments and what touches it, at tensions and a distance."""
    tensions, chain = np.array([3.0, 1.0]), Chain([segment, segment])
    placed = chain.place(tensions)
    base, tip = (c + CORNERS @ R.T for c, R in zip(placed.centres, placed.rotations, strict=True))
    base, tip = (places[np.argmax(places[:, 1])] for places in (base, tip))
    found: Object
    if name == "plane":
        found = facing_plane(rod.SIDE, (0.0, 0.1))
    elif name == "plane along both":  # which presses the tip further than it is moved by the middle
        along = tip - np.array([0, 0.00065, 0]) - base
        found = Plane(centre=tuple(base - [0, 0.05, 0]), normal=(along[1], -along[0], 0.0), **WHERE)
    elif name == "box":
        found = box(
            centre=tuple(tip + np.array([0.008, -0.02, 0])), sides=(0.02, 0.01, 0.02), rotation=(0.1, 0.2, 0.3), **WHERE
        )
    else:
        found = Sphere(centre=tuple(base - [0, 0.05 - 0.004, 0]), radius=0.004, **WHERE)
    model, alone = TouchedSegment(segment=chain, obstacle=found), Chain([replace(segment, skin=None)] * 2)
    touch = replace(model, segment=alone).outputs([*tensions, 0.1])[0, 4]  # of plates
    return model, np.array([*tensions, touch - 1e-3])


@pytest.mark.parametrize("name", OBJECTS)
def test_an_object_presses_on_whichever_plate_it_touches(segment, name):
    """Against the rod under the wrenches that were found: no corner is behind a plane, those that press are on it."""
    model, point = pressed(segment, name)
    found = model.answers(point)
    wrenches = found.wrenches[0].reshape(2, 6)
    assert found.evaluations[0] > 0 and found.out[0, 3] > 0.01
    assert found.inside[0] or found.rubber_gaps[0] < 0  # a plane along both cuts the rubber before them
    assert set(np.flatnonzero(np.abs(wrenches[:, :3]).max(axis=1) > 1e-9)) == OBJECTS[name]
    total = np.zeros(3)
    for wrench, (centre, turned) in zip(wrenches, whole(point[:2], wrenches), strict=True):
        force = turned @ wrench[:3]
        total += force
        if isinstance(model.obstacle, Plane):
            away = np.array(model.obstacle.normal) / np.linalg.norm(model.obstacle.normal)
            place = np.array(model.obstacle.centre) + point[2] * np.array(model.obstacle.direction)
            gap = float(((centre + CORNERS @ turned.T - place) @ away).min())
            assert gap > -2e-5 and (np.linalg.norm(force) < 1e-9 or gap < 2e-5)
            assert np.cross(force, away) == pytest.approx(np.zeros(3), abs=1e-3 * np.linalg.norm(force))
    assert found.out[0, 3] == pytest.approx(-total @ model.obstacle.numbers()["direction"], rel=1e-3)


@pytest.mark.parametrize("name", OBJECTS)
def test_derivatives_of_a_touched_chain_are_those_of_its_answers(segment, name):
    model, point = pressed(segment, name)
    jacobian = model.jacobian(point)
    for k, h in enumerate((2e-4, 2e-4, 2e-8)):
        unit = h * np.eye(3)[k]
        differences = (model.outputs(point + unit)[0] - model.outputs(point - unit)[0]) / (2 * h)
        assert jacobian[:, k] == pytest.approx(differences, rel=5e-4, abs=5e-4 * np.abs(differences[:3]).max())


def test_a_finger_of_two_segments_holds_and_reaches(segment):
    model, point = pressed(segment, "plane")
    finger = Finger(model)
    held = finger.hold(0.1, float(point[2]))
    assert held.converged and model.outputs([*held.tensions, point[2]])[0, 3] == pytest.approx(0.1, abs=1e-6)
    assert finger.locate(held.tensions, 0.1).distance == pytest.approx(point[2], abs=1e-6)


def test_a_chain_is_kept_in_one_file(segment, tmp_path):
    chain = Chain([segment, segment])
    chain.save(tmp_path / "finger.h5")
    again = Chain.load(tmp_path / "finger.h5")
    kept, before = again.place(TENSIONS, WRENCHES), chain.place(TENSIONS, WRENCHES)
    assert kept.centres == pytest.approx(before.centres, abs=1e-6) and len(again.segments) == 2
    segment.save(tmp_path / "one.h5")
    assert len(Chain.load(tmp_path / "one.h5").segments) == 1
    words = [sys.executable, "-m", "rom", "chain", *[str(tmp_path / "one.h5")] * 2, "-o", str(tmp_path / "two.h5")]
    made = json.loads(subprocess.run([*words, "--json"], capture_output=True, text=True, check=True).stdout)
    assert len(made["segments"]) == 2 and Chain.load(tmp_path / "two.h5").scene["geometry"]["segments"] == [0.05, 0.05]
    nowhere = subprocess.run([*words[:-1], str(tmp_path / "none" / "two.h5")], capture_output=True, text=True)
    assert nowhere.returncode == 2 and "output must be in a folder that exists" in nowhere.stderr
    held = [sys.executable, "-m", "control", "hold", str(tmp_path / "two.h5"), "--distance", "0.01", "--contact-force"]
    motion = json.loads(subprocess.run([*held, "0.05", "--json"], capture_output=True, text=True, check=True).stdout)
    assert motion["status"] == "converged"
