"""The full-order plant: pulls that go on from the last one feel what pulls from rest do."""

import numpy as np
import pytest

from fingerfem.full_order_plant import FullOrderPlant

DISTANCE = 0.012


@pytest.mark.long
def test_pulls_go_on_from_the_last_one_and_feel_the_same(draft):
    random = np.random.default_rng(3)
    plant, other = FullOrderPlant(draft, DISTANCE), FullOrderPlant(draft, 0.008)
    felt, iterations, tensions = [], 0, np.array([30.0, 10.0])
    for k in range(10):
        tensions = np.clip(tensions + random.uniform(-1, 3, 2), 0, 100)
        force = plant.pull(tensions)
        iterations += draft.continuation.iterations if k else 0
        assert other.pull(tensions) >= force  # of a nearer plane, with the same model between
        felt.append((tensions, force))
    from_rest = 0
    for tensions, force in felt[1:]:
        assert FullOrderPlant(draft, DISTANCE).pull(tensions) == pytest.approx(force, abs=1e-7)
        from_rest += draft.continuation.iterations
    assert plant.solves == 10 and max(force for _, force in felt) > 0.5
    assert iterations < 0.6 * from_rest


def test_what_the_scene_does_not_allow_is_refused(draft):
    with pytest.raises(ValueError, match="d must lie in"):
        FullOrderPlant(draft, 1.0)
    with pytest.raises(ValueError, match="F1 must lie in"):
        FullOrderPlant(draft, DISTANCE).pull([200.0, 0.0])
