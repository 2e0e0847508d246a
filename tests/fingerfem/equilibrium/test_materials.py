"""Fingers of several materials: closed forms of bars and beams, and the one-law state where laws are equal."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq

from fingerfem import FingerModel, LoadNotReached, load_scene
from fingerfem.scene.scene import Scene

SCENES = Path(__file__).resolve().parents[3] / "scenes"
LENGTH, SIDE = 0.049, 0.010  # of the rubber between clamp and plate [m]
E, TIMES, PULL = 1e7, 7.0, 40.0  # [Pa], modulus of the other material over it [-], [N]


def saint_venant_kirchhoff(E: float) -> dict[str, Any]:
    """Without Poisson's ratio: sections stay as they are, and bars have closed forms."""
    return {"law": "saint-venant-kirchhoff", "E": E, "nu": 0.0}


def model(others: list[dict[str, Any]], tendon: dict[str, Any] | None = None, **changes: Any) -> FingerModel:
    axial = {"name": "F1", "path": "straight", "offset": [0.0, 0.0], "segment": 1, "tension": [0.0, 100.0]}
    table = {
        "name": "bar",
        "geometry": {"side": SIDE, "segments": [LENGTH + 0.001], "plate": 0.001},
        "material": saint_venant_kirchhoff(E),
        "materials": others,
        "tendons": [axial | (tendon or {})],
        "mesh": {"cells": [10, 5]},
    }
    return FingerModel(Scene.model_validate(table | changes))


def rectangle(centre: float, height: float, **changes: Any) -> dict[str, Any]:
    """A layer across the finger."""
    own = {"name": "layer", "region": "rectangle", "centre": [centre, 0.0], "size": [height, SIDE]}
    return own | {"material": saint_venant_kirchhoff(TIMES * E)} | changes


def stretch(stiffness: float) -> float:
    """Stretch of a compressed bar of stiffness E A [N]: E A (l - l^3) / 2 = F."""
    return brentq(lambda s: stiffness * (s - s**3) / 2 - PULL, 3**-0.5, 1.0)


def test_materials_side_by_side_add_their_stiffness():
    height = 0.002
    state = model([rectangle(0.0, height)]).solve([PULL])
    expected = stretch(E * (SIDE**2 + (TIMES - 1) * SIDE * height))
    assert state.tip[0] == pytest.approx((expected - 1) * LENGTH, rel=1e-4)


def test_materials_behind_one_another_add_their_shortening():
    joint = {"name": "joint", "region": "section", "x": [0.01, 0.03], "material": saint_venant_kirchhoff(TIMES * E)}
    state = model([joint]).solve([PULL])
    soft, stiff = (stretch(modulus * SIDE**2) - 1 for modulus in (E, TIMES * E))
    assert state.tip[0] == pytest.approx(soft * (LENGTH - 0.02) + stiff * 0.02, rel=1e-5)


def test_a_stiff_layer_moves_the_neutral_axis_as_beam_theory_says():
    """Curvature F (e - y0) / EI about y0 = sum E A y / sum E A, and strain -F / EA there: Euler, Bernoulli."""
    height, offset, F = 0.001, 0.004, 0.02
    centre = (height - SIDE) / 2
    tendon = {"path": "channel", "offset": [offset, 0.0], "tension": [0.0, 1.0]}
    finger = model([rectangle(centre, height)], tendon, mesh={"cells": [10, 7], "order": 2})
    state = finger.solve([F])
    rubber, layer = E * SIDE**2, (TIMES - 1) * E * SIDE * height
    y0 = layer * centre / (rubber + layer)
    bending = rubber * SIDE**2 / 12 + layer * height**2 / 12 + rubber * y0**2 + layer * (centre - y0) ** 2
    curvature = F * (offset - y0) / bending
    assert state.tip[1] == pytest.approx(curvature * LENGTH * (LENGTH / 2 + 0.0005), rel=2e-3)
    at_axis = (-F / (rubber + layer) + curvature * y0) * LENGTH
    assert state.tip[0] == pytest.approx(at_axis, rel=2e-3)


LAWS = {
    "neo-hookean": {"law": "neo-hookean", "C1": 1.9e6, "D1": 2.43e-7},
    "mixed": {"law": "yeoh", "C1": 1e6, "C2": 1e5, "D1": 1e-9},
}


@pytest.mark.parametrize("law", LAWS.values(), ids=list(LAWS))
def test_equal_laws_give_the_state_of_one(law):
    """Regions end at grid lines that are there without them: the channel's, and the mesh's along the axis."""
    channel = {"path": "channel", "offset": [0.004, 0.0]}
    gravity = {"density": 1100.0, "direction": [0.0, -1.0, 0.0]}
    layer = rectangle(-0.004, 0.002, material=law, x=[0.0, LENGTH * 5 / 9], density=1100.0)
    joint = {"name": "joint", "region": "section", "material": law, "x": [LENGTH * 5 / 9, LENGTH * 7 / 9]}
    one, several = (model(others, channel, material=law, gravity=gravity) for others in ([], [layer, joint]))
    found, expected = several.solve([30.0]), one.solve([30.0])
    assert np.abs(several.problem.mesh.lines - one.problem.mesh.lines).max() < 1e-12
    scale = np.abs(expected.displacement).max()
    assert np.abs(found.displacement - expected.displacement).max() < 1e-12 * scale
    assert found.energy == pytest.approx(expected.energy, rel=1e-11)
    assert found.smallest_volume_ratio == pytest.approx(expected.smallest_volume_ratio, rel=1e-11)


def test_a_displacement_law_beside_a_mixed_one_balances_the_potential():
    """dP/dF is the tendon's length: forces and energy of both forms are of one potential."""
    others = [rectangle(-0.0045, 0.001, material=LAWS["neo-hookean"])]
    finger = model(others, {"path": "channel", "offset": [0.0, 0.0]}, material=LAWS["mixed"], mesh={"cells": [10, 7]})
    step, energies = 0.05, []
    for pull in (20 - step, 20 + step):
        energies.append(finger.solve([pull], sensitivities=False).energy)
    finger.solve([20.0], sensitivities=False)
    assert np.diff(energies)[0] / (2 * step) == pytest.approx(finger.problem.tendon_length(0), rel=1e-6)


def test_every_material_weighs_what_its_density_says():
    gravity = {"density": 1000.0, "plate_density": 0.0, "direction": [0.0, -1.0, 0.0], "acceleration": 1.0}
    finger = model([rectangle(-0.0045, 0.001, density=3000.0)], gravity=gravity, mesh={"cells": [10, 7]})
    weight = SIDE * LENGTH * (1000.0 * SIDE + 2000.0 * 0.001)
    assert finger.solve([0.0]).clamp_reaction[1] == pytest.approx(weight, rel=1e-6)


def test_a_material_beyond_its_own_data_marks_the_state_by_its_name():
    own = {"law": "neo-hookean", "C1": 1.9e6, "D1": 2.43e-7, "stretches": [0.99, 1.01]}
    rubber = LAWS["neo-hookean"] | {"stretches": [0.5, 2.0]}
    state = model([rectangle(0.0, 0.002, material=own)], material=rubber).solve([PULL], sensitivities=False)
    assert state.beyond_data and list(state.guesses) == ["layer"]
    assert state.marks[0].startswith("the law of layer is a guess at stretches of")
    low, high = state.stretches
    assert low <= state.guesses["layer"][0] < 0.99 and high >= state.guesses["layer"][1]


def test_a_material_beyond_what_its_law_can_answer_is_a_failure_that_names_it():
    soft = rectangle(0.0, 0.002, name="core", material=saint_venant_kirchhoff(1e5))
    law = {"law": "neo-hookean", "C1": 2e4, "D1": 2.4e-5}
    finger = model([soft], material=law)
    with pytest.raises(LoadNotReached, match=r"the material core is compressed to a stretch of 0\.\d+, below 0\.5774"):
        finger.solve([20.0], sensitivities=False)
    # Halving finds the last load with an answer, and no strategy but the first looks for another equilibrium.
    least, _ = finger.problem.limits.extreme_stretches()["core"]
    assert 0 <= least - 3**-0.5 < 1e-3
    assert finger.continuation.wasted <= 20
    assert set(finger.continuation.strategies) == {"mixed"}


def test_fields_are_of_each_material_s_own_law():
    from fingerfem.output.cell_fields import cell_fields

    finger = model([rectangle(0.0, 0.002)])
    finger.solve([PULL], sensitivities=False)
    fields = cell_fields(finger)
    regions = finger.problem.mesh.cells.values
    inside, outside = (fields["S11"][(regions // 32 == k) & (regions % 32 <= 2)] for k in (1, 0))
    assert inside / TIMES == pytest.approx(np.full(len(inside), outside.mean()), rel=0.01)
    assert np.isnan(fields["S11"][np.isin(regions, (3, 4, 5, 6, 7))]).all()


def test_the_finger_with_a_fabric_bends_towards_it_as_its_chamber_alone_would_not():
    scene = load_scene(SCENES / "fabric.toml")
    state = FingerModel(scene).solve([0.0, 30e3])
    assert state.stable and not state.marks and state.tip[1] < -3e-3
    plain = FingerModel(scene.model_copy(update={"materials": []})).solve([0.0, 30e3], sensitivities=False)
    assert abs(plain.tip[1]) < 1e-8 and plain.tip[0] > state.tip[0]


@pytest.mark.mpi
def test_what_is_not_a_number_on_one_rank_exceeds_the_limits_on_all():
    table = model([]).scene
    shared = FingerModel(table, MPI.COMM_WORLD)
    assert shared.problem.limits.exceeded() is None
    if MPI.COMM_WORLD.rank == 0:
        shared.problem.displacement[0] = np.nan
    reasons = MPI.COMM_WORLD.allgather(shared.problem.limits.exceeded())
    assert reasons == ["a cell is turned inside out"] * MPI.COMM_WORLD.size
    stretches = MPI.COMM_WORLD.allgather(shared.problem.limits.extreme_stretches()["rubber"])
    assert stretches == [(0.0, np.inf)] * MPI.COMM_WORLD.size
