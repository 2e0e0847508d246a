"""Variables in place of tensions: resultants first, and mirrors of the section permute them."""

import numpy as np
import pytest

from rom.elements.samples.symmetry import mirrors
from rom.elements.samples.tension_map import RESULTANTS, of_scene, tension_map
from tests.rom.elements import elastic_rod

DIAGONAL = np.array([[3.0, 3.0], [3.0, -3.0], [-3.0, 3.0], [-3.0, -3.0]]) * 1e-3
SECTIONS = {
    "four": elastic_rod.FOUR,
    "four short and four long": np.concatenate([elastic_rod.FOUR, 0.75 * elastic_rod.FOUR]),
    "axes and diagonals": np.concatenate([elastic_rod.FOUR, DIAGONAL]),
    "five anywhere": np.array([[4.0, 0.0], [1.0, 3.0], [-2.0, 1.0], [-3.0, -2.0], [0.5, -4.0]]) * 1e-3,
    "three in a row": np.array([[-4.0, 0.0], [1.0, 0.0], [3.0, 0.0]]) * 1e-3,
}


@pytest.mark.parametrize("offsets", SECTIONS.values(), ids=SECTIONS)
def test_tensions_of_no_force_and_no_moment_change_no_resultant_variable(offsets):
    matrix, orders = tension_map(offsets)
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(len(offsets)), atol=1e-12)
    own = matrix[orders <= RESULTANTS]
    resultants = np.column_stack([np.ones(len(offsets)), 1e3 * offsets]).T
    assert len(own) == np.linalg.matrix_rank(resultants) < len(offsets)
    np.testing.assert_allclose(resultants @ matrix[orders > RESULTANTS].T, 0, atol=1e-10)


@pytest.mark.parametrize("offsets", [elastic_rod.TWO, elastic_rod.FOUR[:3]], ids=["two", "three"])
def test_tensions_that_resultants_determine_are_variables_themselves(offsets):
    np.testing.assert_array_equal(tension_map(offsets).matrix, np.eye(len(offsets)))


@pytest.mark.parametrize("name", ["four", "four short and four long", "axes and diagonals"])
def test_a_mirror_of_the_section_permutes_the_variables_but_for_signs(name):
    scene = elastic_rod.scene(offsets=SECTIONS[name])
    found, matrix, t = mirrors(scene), of_scene(scene).matrix, len(SECTIONS[name])
    assert len(found) == 7
    for mirror in found:
        exchange = matrix @ mirror.inputs[:t, :t] @ matrix.T
        np.testing.assert_allclose(mirror.combined(of_scene(scene)).inputs[:t, :t], exchange, atol=1e-12)
        np.testing.assert_allclose(np.abs(exchange).max(axis=0), 1, atol=1e-12)


def test_two_tendons_at_one_offset_are_refused():
    with pytest.raises(ValueError, match=r"tendons\.offset must differ from tendon to tendon, got "):
        tension_map(elastic_rod.FOUR[[0, 1, 2, 1]])
