"""The draft finger's map with its surrogate behind it, on full-order states that the map alone does not know."""

import numpy as np
import pytest

from control import Finger
from rom import BackedSegment, Sphere, Surrogate, TouchedSegment
from rom.checked_file import ModelError

FORCE = 3.0  # that the rod is trained with [N]; the surrogate has more


@pytest.fixture(scope="module")
def backed(touched, surrogate) -> BackedSegment:
    return BackedSegment(touched=touched, surrogate=surrogate)


def test_what_the_map_knows_is_the_map_s_all_else_the_surrogate_s(backed, touched, surrogate):
    lower, upper = backed.limits
    points = lower + np.random.default_rng(0).random((500, 3)) * (upper - lower)
    known = touched.answers(points)
    answer, behind = backed.evaluate(points), surrogate.evaluate(points)
    rubber = known.rubber_gaps < touched.rod.errors.surface
    assert 0.05 < np.mean(~known.inside) < 0.9 and rubber.any()
    assert answer.inside[known.inside].all() and (answer.inside == known.inside | behind.inside).all()
    force = np.where(known.inside, known.out[:, 3], behind.contact_force)
    assert (answer.contact_force == force).all() and (backed.outputs(points)[:, 3] == force).all()
    for k in (int(np.argmax(known.inside)), int(np.argmin(known.inside))):
        one = backed.evaluate(points[k])
        assert one.contact_force == force[k] and one.error["contact_force"] == answer.error["contact_force"][k]
        own = touched if known.inside[k] else surrogate
        assert (backed.jacobian(points[k]) == own.jacobian(points[k])).all()


def test_every_full_order_contact_of_the_plane_is_answered(backed, held_out):
    points, true = held_out.random("parameters"), held_out.random("contact_force")
    felt = true > 0.05
    answer = backed.evaluate(points[felt])
    beyond = ~backed.touched.answers(points[felt]).inside
    error = np.abs(answer.contact_force - true[felt]) / true[felt]
    assert answer.inside.all() and 0 < beyond.sum() < felt.sum()
    assert np.median(error) < 3e-3 and error.max() < 0.05  # this map is of a hundred states
    assert np.mean(np.abs(answer.contact_force - true[felt]) <= answer.error["contact_force"]) > 0.85


@pytest.mark.parametrize("force, d", [(1.0, 0.012), (2 * FORCE, 0.004)])
def test_holds_what_either_of_them_knows(backed, surrogate, force, d):
    motion = Finger(backed).hold(force, d)
    assert motion.converged
    answer = backed.evaluate([*motion.tensions, d])
    assert answer.inside and abs(answer.contact_force - force) < 1e-5
    alone = Finger(surrogate).hold(force, d)
    assert abs(backed.evaluate([*alone.tensions, d]).contact_force - force) < 0.02 * force
    located = Finger(backed).locate(motion.tensions, force)
    assert located.converged and abs(located.distance - d) < 1e-5
    assert (force > FORCE) == (Finger(backed.touched).hold(force, d).status == "out_of_domain")


def test_refuses_another_finger_and_another_object(touched, surrogate):
    with pytest.raises(ModelError, match="of the map's mesh"):
        BackedSegment(touched=touched, surrogate=Surrogate.load())
    ball = Sphere(centre=(0.045, 0.02, 0.0), radius=0.005, direction=(0.0, 1.0, 0.0))
    with pytest.raises(ModelError, match="another object"):
        BackedSegment(touched=TouchedSegment(rod=touched.rod, obstacle=ball), surrogate=surrogate)
