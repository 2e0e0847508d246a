"""Elements of an elastic rod: they predict what they were not trained on, and say by how much."""

from dataclasses import replace

import numpy as np
import pytest

from rom.dataset.snapshot_set import SnapshotError
from rom.elements import rotation_vectors
from rom.elements.fitting import degrees, training
from rom.elements.fitting.regression import NormalEquations
from rom.elements.samples.cuts import END, LONGEST, cut
from rom.elements.samples.element_samples import element_samples
from rom.elements.samples.section_states import Bodies
from tests.rom.elements import elastic_rod
from tests.rom.elements.images import image


@pytest.fixture(scope="module")
def prepared(rod_states):
    return training.prepare(rod_states)


def test_a_finger_is_cut_into_end_pieces_of_a_side_and_interior_elements_between_them():
    at = np.arange(50) * 0.001
    found = cut(at, 0.010)
    ((begin, first),), ((last, plate),) = found["clamp"], found["plate"]
    assert begin == 0 and plate == len(at)
    assert at[first] == pytest.approx(END * 0.010) and at[-1] - at[last] == pytest.approx(END * 0.010)
    lengths = [at[j] - at[i] for i, j in found["interior"]]
    assert min(lengths) == pytest.approx(0.001) and max(lengths) == pytest.approx(LONGEST * 0.010)
    assert all(first <= i < j <= last for i, j in found["interior"])


def test_a_finger_shorter_than_two_end_pieces_is_one_element():
    assert cut(np.arange(19) * 0.001, 0.010) == {"whole": [(0, 19)]}


def test_lines_left_out_are_predicted_as_well_as_held_out_states(finger, rod_elements, prepared):
    """Left out or held out, the finger is predicted alike; and far better than its elements' lowest degree does."""
    held_out = elastic_rod.states(10, 77)
    left_out = rod_elements.provenance["left_out"]["place_m"]
    off = np.linalg.norm(elastic_rod.placed(finger, held_out.inputs)[0] - held_out.plate.places, axis=1)
    assert np.median(off) < 2 * left_out["median"] and np.quantile(off, 0.95) < 2 * left_out["p95"]
    turned = rotation_vectors.angles(elastic_rod.placed(finger, held_out.inputs)[1], held_out.plate.rotations)
    states = zip(held_out.inputs, held_out.shortenings[:, -1], strict=True)
    shorter = np.array([finger.shortening(row[:2], row[None, 2:]) - own for row, own in states])
    for errors, name in ((turned, "turn_rad"), (np.abs(shorter).max(axis=1), "shortening_m")):
        known = rod_elements.provenance["left_out"][name]
        assert 0 < np.median(errors) < 2 * known["median"] and np.quantile(errors, 0.95) < 2 * known["p95"]
    lowest = prepared.score(dict.fromkeys(prepared.kinds, degrees.LOWEST))
    assert prepared.score(rod_elements.provenance["degrees"]) < 1e-2 * lowest


def test_a_finger_of_too_few_lines_is_refused():
    few = elastic_rod.states(3, 0)
    with pytest.raises(SnapshotError, match="lines with an answer must be at least 4 to train elements, got 3"):
        training.prepare(few)


def test_elements_are_not_trained_where_the_material_changes_along_the_axis(rod_states):
    part = {"name": "stiff", "region": "section", "x": [0.02, 0.03], "material": rod_states.scene["material"]}
    states = replace(rod_states, scene=rod_states.scene | {"materials": [part]})
    with pytest.raises(SnapshotError, match=r"materials.stiff.x must be left out to train elements: .*, got \[0.02"):
        training.prepare(states)


def test_left_out_predictions_are_those_of_a_training_without_these_lines(rod_states, prepared):
    """The normal equations without a fold are those of the other folds and their images alone."""
    clamp = prepared.kinds["clamp"]
    kept = prepared.fold != 0

    def some(bodies: Bodies) -> Bodies:
        return Bodies(places=bodies.places[kept], rotations=bodies.rotations[kept], motions=bodies.motions[kept])

    fewer = replace(
        rod_states,
        inputs=rod_states.inputs[kept],
        lines=rod_states.lines[kept],
        sections=some(rod_states.sections),
        plate=some(rod_states.plate),
        shortenings=rod_states.shortenings[kept],
        shortening_changes=rod_states.shortening_changes[kept],
        corners=rod_states.corners[kept],
        corner_changes=rod_states.corner_changes[kept],
    )
    samples = element_samples(fewer, 0, 10)
    equations = clamp.equations
    alone = NormalEquations(equations.lower, equations.upper, equations.powers, 1, samples.values.shape[1])
    for part in (samples, *(image(mirror, samples) for mirror in rod_states.mirrors)):
        alone.add(part.inputs, part.values, part.jacobians, np.zeros(len(part.inputs), int))
    chosen = np.flatnonzero(equations.powers.sum(axis=1) <= 2)
    inputs = element_samples(rod_states, 0, 10).inputs
    np.testing.assert_allclose(equations.fit(chosen, [0]).value(inputs), alone.fit(chosen).value(inputs), atol=1e-9)


def test_a_degree_above_the_usual_one_is_tried_where_it_is_asked_for(prepared, rod_states, rod_elements):
    more = training.prepare(rod_states, degrees.HIGHEST + 1)
    assert max(one.highest for one in prepared.kinds.values()) == degrees.HIGHEST
    assert more.kinds["interior"].highest == degrees.HIGHEST + 1
    chosen = degrees.best_degrees(more.score, more.kinds)
    assert more.score(chosen) <= prepared.score(rod_elements.provenance["degrees"])
    assert all(more.kinds[kind].supports(degree) for kind, degree in chosen.items())
