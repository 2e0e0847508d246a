"""A finger with friction of its tendons along the poses of a log."""

import numpy as np

import rom
from control.calibration.guided import along


def test_poses_at_the_ends_of_the_domain_are_inside_it_with_derivatives_too():
    points = np.array([[0.0, 0.0, np.inf], [30.0, 0.0, np.inf], [100.0, 10.0, np.inf], [20.0, 5.0, np.inf]])
    found, plain = along(rom.load(), points, 0.2), along(rom.load(), points, 0.2, derivatives=False)
    assert found.inside.all() and plain.inside.all()
    assert (found.values == plain.values).all()
