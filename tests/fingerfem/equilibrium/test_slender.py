"""Slender fingers are beams: elastica, tendon arc, tendon arc against a plane, buckling.

Rubber of Poisson's ratio 0, a plate as thin as side^2 / length, quadratic cells; what differs from a beam without
thickness falls with side over length and is extrapolated away.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from fingerfem import FingerModel
from fingerfem.equilibrium.newton import NewtonOptions
from fingerfem.scene.laws import neo_hookean_from
from fingerfem.scene.scene import Scene

SIDE, E = 0.010, 1e7
EI = E * SIDE**4 / 12
LAW = neo_hookean_from(E, 0.0)


def finger(slenderness: float, offset: float = 0.0, path: str = "channel", obstacle: dict | None = None) -> FingerModel:
    """A finger of the given rubber length over side; the tendon's offset is over the side."""
    length = slenderness * SIDE
    plate = SIDE**2 / length
    scene = {
        "name": "slender",
        "geometry": {"side": SIDE, "segments": [length + plate], "plate": plate},
        "material": {"law": "neo-hookean", "C1": LAW.C1, "D1": LAW.D1},
        "tendons": [{"name": "F", "offset": [offset * SIDE, 0.0], "segment": 1, "path": path, "tension": [0.0, 1e4]}],
        "mesh": {"cells": [int(slenderness) + 1, 3], "order": 2},
    }
    if offset == 0:
        scene["geometry"]["channel"] = SIDE  # no grid lines for a tendon that is not pulled
        scene["mesh"]["cells"][1] = 2
    return FingerModel(Scene.model_validate(scene | ({"obstacle": obstacle} if obstacle else {})))


class DeadLoad:
    """A force on the tip plate that keeps its direction, added to a model's residual and nothing else."""

    def __init__(self, model: FingerModel, axis: int):
        self.model, self.force = model, 0.0
        self._direction = model.problem.tip_gradient(axis)
        self._residual = model.problem.residual
        model.continuation.newton.options = NewtonOptions(divergence=1e12, iterations=40)  # steps without a predictor
        model.problem.residual = self.residual

    def residual(self):
        b, reaction = self._residual()
        b.axpy(-self.force, self._direction)
        return b, reaction

    def equilibrium(self, force: float) -> None:
        self.force = force
        self.model.continuation.newton.solve("mixed")


def extrapolated(ratios, values, powers) -> np.ndarray:
    """The limit of values for side / length -> 0, from as many ratios as there are powers and the limit."""
    small = 1 / np.asarray(ratios, float)
    return np.linalg.solve(np.column_stack([small**power for power in (0, *powers)]), np.asarray(values))[0]


# P L^2 / EI, w / L, u / L: exact elliptic integrals
ELASTICA = [(1.0, 0.3017207738, 0.0564332363), (5.0, 0.7137915236, 0.3876283607), (10.0, 0.8106090249, 0.5549955978)]


@pytest.fixture(scope="module")
def elastica() -> dict[float, list[np.ndarray]]:
    """Tip displacement over length at the three loads, by slenderness."""
    found = {}
    for slenderness in (20, 40):
        model = finger(slenderness)
        length = slenderness * SIDE
        load, tips = DeadLoad(model, 1), []
        model.continuation.rest()
        for step in np.arange(0.25, 10.01, 0.25):
            load.equilibrium(step * EI / length**2)
            if step in (1.0, 5.0, 10.0):
                tips.append(model.problem.tip() / length)
        found[slenderness] = tips
    return found


@pytest.mark.long
@pytest.mark.parametrize("case", [0, 1, 2])
def test_a_dead_load_at_the_tip_bends_the_elastica(elastica, case):
    _, w, u = ELASTICA[case]
    tips = [elastica[slenderness][case] for slenderness in (20, 40)]
    assert extrapolated((20, 40), [tip[1] for tip in tips], [2]) == pytest.approx(w, rel=0.005)
    assert extrapolated((20, 40), [-tip[0] for tip in tips], [2]) == pytest.approx(u, rel=0.005)


def test_the_elastica_is_approached_with_the_square_of_side_over_length(elastica):
    errors = [abs(elastica[slenderness][0][1] - ELASTICA[0][1]) for slenderness in (20, 40)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("m", [*(pytest.param(one, marks=pytest.mark.long) for one in (0.5, 1.5))])
def test_a_guided_tendon_bends_a_circle(m):
    """x / L = sin(m) / m, w / L = (1 - cos m) / m with m = F e L / EI, both shortened by 1 - F / EA to first order."""
    positions, ratios = [], (20, 40, 80)
    for slenderness in ratios:
        model, length = finger(slenderness, 0.4), slenderness * SIDE
        tension = m * EI / (0.4 * SIDE * length)
        tip = model.solve([tension], sensitivities=False).tip / length
        positions.append([(1 + tip[0]) / (1 - tension / (E * SIDE**2)), tip[1] / (1 - tension / (E * SIDE**2))])
    x, w = (extrapolated(ratios, values, [1, 2]) for values in np.transpose(positions))
    assert x == pytest.approx(np.sin(m) / m, rel=0.005)
    assert w == pytest.approx((1 - np.cos(m)) / m, rel=0.005)


# m / m_c and r = N L^2 / EI of theta' = m - r (x_tip - x) with d / L = 0.1, m_c = 0.2006725111
@pytest.mark.parametrize(
    ("over_touch", "r"), [pytest.param(*one, marks=pytest.mark.long) for one in ((1.25, 0.07588679), (2.0, 0.30389948))]
)
def test_a_tendon_arc_is_held_back_by_the_plane(over_touch, r):
    m, forces, ratios = over_touch * 0.2006725111, [], (20, 40, 80)
    for slenderness in ratios:
        length = slenderness * SIDE
        plane = {"distance": [1e-3, 0.5], "method": "penalty"}
        model = finger(slenderness, 0.4, obstacle=plane)
        state = model.solve([m * EI / (0.4 * SIDE * length)], 0.1 * length, sensitivities=False)
        forces.append(state.contact_force * length**2 / EI)
    assert extrapolated(ratios, forces, [1, 2]) == pytest.approx(r, rel=0.01)


def buckling(model: FingerModel, load_to, expected: float) -> float:
    """Load at which the straight finger's tangent first has a negative eigenvalue, over the expected one."""

    def stable(ratio: float) -> bool:
        model.continuation.rest()
        load_to(ratio * expected)
        return model.continuation.linearise().negative_pivots == 0

    assert stable(0.8) and not stable(1.2)
    return brentq(lambda ratio: 1.0 if stable(ratio) else -1.0, 0.8, 1.2, xtol=1e-4)


def test_a_column_buckles_under_a_dead_load_as_euler_says():
    """2.4674011 EI / L^2 for a column clamped at one end and free at the other."""
    found = []
    for slenderness in (20, 40):
        model = finger(slenderness)
        load = DeadLoad(model, 0)
        found.append(
            buckling(model, lambda P, load=load: load.equilibrium(-P), 2.4674011 * EI / (slenderness * SIDE) ** 2)
        )
    assert extrapolated((20, 40), found, [2]) == pytest.approx(1.0, abs=0.005)


@pytest.mark.long
def test_a_straight_tendon_on_the_axis_buckles_its_finger_at_four_times_that():
    """A pull towards a fixed point at the clamp: pi^2 EI / L^2 (Timoshenko, Gere, Theory of Elastic Stability, 2.4)."""
    found = []
    for slenderness in (20, 40):
        model = finger(slenderness, path="straight")

        def pull(tension, model=model):
            model.problem.set_loads([tension], None)
            model.continuation.newton.solve("plain")

        found.append(buckling(model, pull, np.pi**2 * EI / (slenderness * SIDE) ** 2))
    assert extrapolated((20, 40), found, [2]) == pytest.approx(1.0, abs=0.005)


@pytest.mark.long
def test_two_opposite_guided_tendons_do_not_buckle_a_finger_far_beyond_eulers_load():
    table = finger(20, 0.4).scene.model_dump()
    table["tendons"].append(table["tendons"][0] | {"name": "G", "offset": [-0.4 * SIDE, 0.0]})
    model = FingerModel(Scene.model_validate(table))
    euler = 2.4674011 * EI / (20 * SIDE) ** 2
    state = model.solve([10 * euler, 10 * euler])
    assert state.stable
    assert abs(state.tip[1]) < 1e-9 < -state.tip[0]
