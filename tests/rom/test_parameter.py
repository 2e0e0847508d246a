"""Parameters of models, and tensions and distances as separate arguments."""

import numpy as np
import pytest

import rom
from rom.parameter import Parameter, joined

POINTS = np.array([[30.0, 0.0, 0.010], [60.0, 20.0, 0.006], [5.0, 0.0, 0.012]])


def test_a_parameter_has_name_unit_and_range():
    assert rom.load().parameters[-1][:2] == ("d", "m")
    assert rom.load().parameters[0] == Parameter(name="F1", unit="N", lower=0.0, upper=100.0)


@pytest.mark.parametrize("of", ["rod", "table"])
def test_separate_arguments_are_the_flat_vector(of, table):
    model = rom.load() if of == "rod" else table
    flat = model.evaluate(POINTS)
    apart = model.evaluate(POINTS[:, :-1], d=POINTS[:, -1])
    assert np.array_equal(flat.tip, apart.tip) and np.array_equal(flat.contact_force, apart.contact_force)
    one = model.evaluate(POINTS[1, :-1], d=0.006)
    assert one.tip.shape == (3,) and one.contact_force == flat.contact_force[1]


def test_one_distance_serves_many_tensions_and_several_objects_have_one_each():
    assert joined(POINTS[:, :-1], 0.01).tolist() == [[*row[:-1], 0.01] for row in POINTS]
    assert joined([1.0, 2.0], [0.1, 0.2, 0.3]).shape == (3, 3)
    assert joined([1.0, 2.0], [0.1, 0.2, 0.3], distances=3).tolist() == [1.0, 2.0, 0.1, 0.2, 0.3]
    with pytest.raises(ValueError, match="shape"):
        joined(POINTS[:, :-1], [0.1, 0.2])


@pytest.mark.parametrize(("tensions", "d", "distances"), [(None, 0.01, 1), (30.0, 0.01, 1), ([30.0, 0.0], 0.01, 2)])
def test_what_is_no_row_is_refused_in_one_line(tensions, d, distances):
    with pytest.raises(ValueError, match="tensions must be a row") as refused:
        joined(tensions, d, distances)
    assert "\n" not in str(refused.value)
