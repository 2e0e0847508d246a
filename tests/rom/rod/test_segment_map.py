"""A segment's map: compiled as in Python, beyond its box as it says, and the same from its file."""

import pickle

import numpy as np
import pytest

from rom import SegmentMap, Surrogate
from rom.checked_file import ModelError
from rom.rod import native
from tests.rom.rod import kirchhoff as rod


def compiled(segment: SegmentMap, inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    pose, motion, t = np.empty(8), np.empty((6, len(inputs))), segment.tensions
    parts = [inputs[:t].copy(), inputs[t:].copy(), pose, motion]
    tensions, wrench, *out = map(native.pointer, parts)
    memory = native.memory_of(segment.struct)
    inside = native.SEGMENT.functions.fingerfem_place(segment.struct, tensions, wrench, memory, *out)
    return pose[:7], motion, bool(inside)


def test_the_compiled_map_is_that_of_python(segment):
    lower, upper = segment.pose.lower, segment.pose.upper
    for inputs in lower + np.random.default_rng(0).random((50, 8)) * (upper - lower):
        pose, motion, inside = compiled(segment, inputs)
        placed = segment.place(inputs)
        assert inside == placed.inside == (np.linalg.norm(inputs[2:5]) <= rod.MOST_FORCE)
        assert pose == pytest.approx(segment.pose.value(inputs[None])[0], abs=1e-12)
        assert motion == pytest.approx(placed.motion, abs=1e-10)


def test_the_plate_is_where_the_rod_says(segment):
    states = rod.states(20, 7)
    placed = segment.place(states.inputs)
    true = -np.einsum("nij,nj->ni", placed.rotation, states.poses[:, :3])
    assert np.linalg.norm(placed.centre - true, axis=1).max() < 2e-5
    assert segment.place(np.zeros(8)).centre == pytest.approx(segment.rest, abs=1e-6)


def test_beyond_its_box_it_goes_on_linearly_and_says_so(segment):
    inputs = np.array([10.0, 5.0, 0.0, 1.2 * rod.MOST_FORCE, 0.0, 0.0, 0.0, 0.0])
    edge = inputs.copy()
    edge[3] = rod.MOST_FORCE
    pose, _, inside = compiled(segment, inputs)
    value, gradient = segment.pose.value_and_gradient(edge[None])
    assert not inside and not segment.place(inputs).inside
    assert pose == pytest.approx(value[0] + gradient[0, :, 3] * (inputs - edge)[3], abs=1e-12)


def test_its_file_holds_it_whole(segment, tmp_path):
    file = tmp_path / "rod.h5"
    segment.save(file)
    again = SegmentMap.load(file)
    assert np.array_equal(again.pose.coefficients, segment.pose.coefficients)
    assert (again.parameters, again.force_error, again.scene) == (
        segment.parameters,
        segment.force_error,
        segment.scene,
    )
    inputs = np.full(8, 0.01)
    assert pickle.loads(pickle.dumps(again)).place(inputs).centre == pytest.approx(
        segment.place(inputs).centre, abs=1e-15
    )
    with pytest.raises(ModelError, match="must be a fingerfem surrogate, got a fingerfem segment map"):
        Surrogate.load(file)
    damaged = bytearray(file.read_bytes())
    damaged[-100] ^= 1
    file.write_bytes(damaged)
    with pytest.raises(ModelError, match="damaged"):
        SegmentMap.load(file)


def test_inputs_of_the_wrong_number_are_refused(segment):
    with pytest.raises(ModelError, match="inputs must be F1, F2, fx"):
        segment.place([1.0, 2.0])
