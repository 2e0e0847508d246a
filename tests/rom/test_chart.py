"""Contact-aligned coordinates of the trained draft finger."""

import numpy as np
import pytest

from rom.chart import coordinates
from rom.kernel import answer


def chart_of(surrogate, point):
    out, jacobian, _ = answer(surrogate.kernel, np.array(point))
    return coordinates(surrogate.kernel.chart, np.array(point), out[4], np.ascontiguousarray(jacobian[4, :-1]))


def touch(surrogate, tensions):
    return float(surrogate.evaluate([*tensions, np.inf]).touch_distance)


def test_touch_is_the_face_s_0_and_the_nearest_plane_the_face_s_1(surrogate):
    tensions = [60.0, 20.0]
    reach = touch(surrogate, tensions)
    assert chart_of(surrogate, [*tensions, reach - 1e-12])[0][2] == pytest.approx(0.0, abs=1e-8)
    assert chart_of(surrogate, [*tensions, 0.001])[0][2] == pytest.approx(1.0)


def test_the_highest_lead_tension_is_the_face_xi_1_and_onset_the_face_xi_0(surrogate):
    assert chart_of(surrogate, [100.0, 40.0, 0.01])[0][0] == pytest.approx(1.0)
    onset = surrogate.forms["onset"].value([40.0])[0]
    assert touch(surrogate, [onset, 40.0]) == pytest.approx(0.001, abs=2e-6)
    assert chart_of(surrogate, [onset, 40.0, 0.001])[0][0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("point", [[60.0, 20.0, 0.012], [20.0, 70.0, 0.003], [90.0, 90.0, 0.0011]], ids=str)
def test_derivatives_are_differences(surrogate, point):
    _, derivative = chart_of(surrogate, point)
    for j, h in enumerate((1e-5, 1e-5, 1e-9)):
        step = h * np.eye(3)[j]
        slope = (chart_of(surrogate, point + step)[0] - chart_of(surrogate, point - step)[0]) / (2 * h)
        assert derivative[:, j] == pytest.approx(slope, rel=1e-5, abs=1e-7)


def test_coordinates_never_leave_the_box(surrogate):
    random = np.random.default_rng(0)
    for point in random.random((500, 3)) * [100, 100, 0.03] + [0, 0, 0.001]:
        where, derivative = chart_of(surrogate, point)
        assert 0 <= where[0] <= 1 and 0 <= where[2] <= 1
        assert np.isfinite(derivative).all()
