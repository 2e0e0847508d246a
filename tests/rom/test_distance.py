"""A distance beyond what a model's parameter allows is not inside, in every model; infinity is no obstacle."""

import numpy as np
import pytest
from assembled import two_segments

from rom import Plane, Sphere, TouchedSegment
from rom.export.model import struct
from rom.native import LIBRARY, pointer

TENSIONS = [30.0, 0.0]


def before_a_ball() -> TouchedSegment:
    ball = Sphere(centre=(0.045, 0.02, 0.0), radius=0.005, direction=(0.0, 1.0, 0.0), distances=(-0.01, 0.03))
    return TouchedSegment(rod=TouchedSegment.load().rod, obstacle=ball)


MODELS = {
    "rod": TouchedSegment.load,
    "two segments": two_segments,
    "rod before a ball": before_a_ball,
}


@pytest.mark.parametrize("name", ["table", *MODELS])
def test_only_distances_of_the_parameter_and_infinity_are_inside(name, table):
    model = table if name == "table" else MODELS[name]()
    lower, upper = (float(end[-1]) for end in model.limits)
    touch = float(model.evaluate([*TENSIONS, np.inf]).touch_distance)
    assert lower < touch < upper
    for d in (np.inf, upper, (touch + upper) / 2):
        assert model.evaluate([*TENSIONS, d]).inside and model.evaluate([*TENSIONS, d]).contact_force == 0
    for d in (10.0, np.nextafter(upper, 1.0), np.nextafter(lower, -1.0), -1.0, -np.inf, np.nan):
        assert not model.evaluate([*TENSIONS, d]).inside
    many = model.evaluate([[*TENSIONS, d] for d in (upper, 10.0, np.inf)])
    assert many.inside.tolist() == [True, False, True]


@pytest.mark.parametrize("name", ["table", *MODELS])
def test_c_alone_marks_the_same_distances(name, table):
    """An FMU and the page in a browser compute this."""
    model = table if name == "table" else MODELS[name]()
    own, (lower, upper) = struct(model), (float(end[-1]) for end in model.limits)
    memory = np.empty(LIBRARY.functions.fingerfem_model_memory(own))
    for d in (np.inf, upper, 10.0, np.nextafter(upper, 1.0), np.nextafter(lower, -1.0), -1.0, np.nan):
        point, out, errors, jacobian, wrench = (
            np.array([*TENSIONS, d]),
            np.empty(6),
            np.empty(4),
            np.empty(36),
            np.zeros(3072),
        )
        given = map(pointer, (point, memory, wrench, out, errors, jacobian))
        status = LIBRARY.functions.fingerfem_model_evaluate(own, *given, LIBRARY.ffi.NULL)
        assert (status == 0) == (d == np.inf or lower <= d <= upper)


def test_without_an_obstacle_nothing_is_touched_wherever_it_may_stand():
    """At infinity no contact is solved for, also where the object may not be as far as the finger reaches."""
    near = Plane(centre=(0.0, 0.005, 0.0), direction=(0, 1, 0), normal=(0, -1, 0), distances=(0.0, 0.002))
    model = TouchedSegment(rod=TouchedSegment.load().rod, obstacle=near)
    free = model.evaluate([60.0, 0.0, np.inf])
    assert free.touch_distance > 0.01 and free.contact_force == 0 and free.inside
    assert np.array_equal(free.tip, TouchedSegment.load().evaluate([60.0, 0.0, np.inf]).tip)
    pressed = model.evaluate([60.0, 0.0, 0.003])  # nearer than it reaches, farther than it may stand
    assert not pressed.inside and pressed.contact_force > 0
