"""Models of tensions and distances: limits, checked points and the leading tension, of one in closed form."""

import numpy as np
import pytest

from rom.answer import TOUCH
from rom.files.checked_file import ModelError
from rom.parameter import Parameter
from rom.parametric_model import ParametricModel


class Closed(ParametricModel):
    """The touch distance is slopes @ tensions + curve F1^2; the rest is 0."""

    def __init__(self, slopes, curve=0.0):
        self.slopes, self.curve = np.array(slopes), curve

    @property
    def parameters(self):
        tensions = [Parameter(f"F{k + 1}", "N", 0.0, 10.0) for k in range(len(self.slopes))]
        return [*tensions, Parameter("d", "m", 0.01, 0.03)]

    def value_and_jacobian(self, parameters):
        tensions = self.checked(parameters, 1)[:-1]
        value, jacobian = np.zeros(5), np.zeros((5, len(tensions) + 1))
        value[TOUCH] = self.slopes @ tensions + self.curve * tensions[0] ** 2
        jacobian[TOUCH, :-1] = self.slopes
        jacobian[TOUCH, 0] += 2 * self.curve * tensions[0]
        return value, jacobian


def test_names_and_limits_are_in_the_order_of_the_parameters():
    model = Closed([1.0, 2.0])
    assert model.names == ["F1", "F2", "d"]
    assert [end.tolist() for end in model.limits] == [[0.0, 0.0, 0.01], [10.0, 10.0, 0.03]]


@pytest.mark.parametrize("slopes", [[1.0, 3.0, 2.0], [5.0, 4.0, 4.5], [-9.0, -4.0, -1.0]])
def test_the_leading_tension_is_the_one_of_the_steepest_slope_and_not_of_the_largest_size(slopes):
    assert Closed(slopes).lead == int(np.argmax(slopes))


def test_the_leading_tension_is_that_of_the_middle_of_the_ranges():
    """The slope by F1 is 1 + 2 (0.25) F1: 1 at no tension, 3.5 in the middle, 6 at the end."""
    assert Closed([1.0, 3.4], 0.25).lead == 0 and Closed([1.0, 3.6], 0.25).lead == 1


def test_points_are_checked_by_their_numbers_and_shape():
    model = Closed([1.0, 2.0])
    assert model.checked([[1, 2, 3]] * 4).shape == (4, 3) and model.checked((1, 2, 3)).dtype == float
    assert model.checked(np.asfortranarray(np.ones((3, 3)))).flags.c_contiguous
    with pytest.raises(ModelError, match=r"parameters must be F1, F2, d \(in that order\), got shape \(1, 3\)"):
        model.jacobian([[1, 2, 3]])
    with pytest.raises(ModelError, match=r"got shape \(2, 2, 3\)"):
        model.checked(np.zeros((2, 2, 3)))
