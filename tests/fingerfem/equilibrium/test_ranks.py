"""One finger shared by ranks is the finger one rank solves."""

from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fingerfem import FingerModel, load_scene

SCENES = Path(__file__).resolve().parents[3] / "scenes"


@pytest.mark.mpi
def test_one_finger_over_all_ranks_gives_the_answer_of_one_rank():
    scene = load_scene(SCENES / "draft.toml")
    alone = FingerModel(scene).solve([50.0, 30.0], 0.005)
    shared = FingerModel(scene, MPI.COMM_WORLD).solve([50.0, 30.0], 0.005)
    assert shared.unknowns == alone.unknowns == 2268
    assert shared.tip == pytest.approx(alone.tip, abs=1e-9 * 0.05)
    assert shared.contact_force == pytest.approx(alone.contact_force, rel=1e-9)
    assert shared.clamp_reaction == pytest.approx(alone.clamp_reaction, abs=1e-8)
    for name in ("F1", "F2", "d"):
        assert shared.sensitivities["contact_force"][name] == pytest.approx(
            alone.sensitivities["contact_force"][name], rel=1e-6
        )


@pytest.mark.mpi
def test_a_failure_is_raised_on_every_rank():
    from fingerfem import LoadNotReached
    from fingerfem.equilibrium.continuation import Continuation, StepOptions
    from fingerfem.equilibrium.newton import NewtonOptions

    model = FingerModel(load_scene(SCENES / "draft.toml"), MPI.COMM_WORLD)
    continuation = Continuation(model.problem, StepOptions(halvings=1))
    continuation.newton.options = NewtonOptions(iterations=2)
    raised = False
    try:
        continuation.advance([100.0, 0.0], None)
    except LoadNotReached:
        raised = True
    assert MPI.COMM_WORLD.allreduce(int(raised)) == MPI.COMM_WORLD.size
    assert np.isfinite(model.problem.displacement).all()
