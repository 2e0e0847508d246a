"""Other scenes go the whole way too: one tendon that touches at its lowest tension, and no obstacle at all."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from control import Finger, Gripper
from fingerfem import FingerModel, load_scene
from rom import Surrogate

ROOT = Path(__file__).resolve().parents[3]
DRAFT = (ROOT / "scenes" / "draft.toml").read_text().split("[sampling]")[0].replace("[20, 5]", "[10, 5]")
SAMPLING = "\n[sampling]\ntension_nodes = 6\ncontact_nodes = 6\n"
SECOND_TENDON = DRAFT[DRAFT.rindex("[[tendons]]") : DRAFT.index("[obstacle]")]
OBSTACLE = DRAFT[DRAFT.index("[obstacle]") : DRAFT.index("[mesh]")]


def trained(folder: Path, text: str) -> tuple[Surrogate, FingerModel]:
    scene = folder / "scene.toml"
    scene.write_text(text + SAMPLING)
    for words in (
        ["mpirun", "-n", "2", sys.executable, "-m", "fingerfem", "snapshots", scene, folder / "set"],
        [sys.executable, "-m", "rom", "build", folder / "set", "-o", folder / "model.h5"],
    ):
        done = subprocess.run(list(map(str, words)), cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    return Surrogate.load(folder / "model.h5"), FingerModel(load_scene(scene))


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    text = DRAFT.replace(SECOND_TENDON, "").replace("tension = [0.0, 100.0]", "tension = [20.0, 60.0]")
    return trained(tmp_path_factory.mktemp("pulled"), text)


@pytest.mark.parametrize(("tension", "distance"), [(20.0, 0.005), (20.0, 0.001), (27.0, 0.004), (55.0, 0.012)])
def test_a_finger_that_touches_at_its_lowest_tension_feels_it(pulled, tension, distance):
    surrogate, model = pulled
    truth = model.solve([tension], distance, sensitivities=False).contact_force
    assert truth > 0.5
    assert surrogate.evaluate([tension, distance]).contact_force == pytest.approx(truth, rel=0.03)


def test_one_tendon_holds_and_finds(pulled):
    surrogate, model = pulled
    motion = Finger(surrogate).hold(2.0, 0.006)
    assert motion.converged
    assert model.solve(motion.tensions, 0.006, sensitivities=False).contact_force == pytest.approx(2.0, rel=0.03)
    assert Finger(surrogate).locate(motion.tensions, 2.0).distance == pytest.approx(0.006, abs=1e-6)
    assert Finger(surrogate).hold(0.1, 0.005).status == "unreachable"  # the lowest tension presses harder already


@pytest.fixture(scope="module")
def free(tmp_path_factory):
    return trained(tmp_path_factory.mktemp("free"), DRAFT.replace(OBSTACLE, ""))


def test_without_an_obstacle_a_surrogate_has_tensions_alone(free):
    surrogate, model = free
    assert surrogate.names == ["F1", "F2"] and set(surrogate.forms) == {"free", "free displacement"}
    answer = surrogate.evaluate([35.0, 60.0])
    assert answer.tip == pytest.approx(model.solve([35.0, 60.0], sensitivities=False).tip, abs=2e-4)
    assert answer.contact_force == 0 and np.isnan(answer.touch_distance)
    assert surrogate.jacobian([35.0, 60.0]).shape == (5, 2)
    assert surrogate.displacement([35.0, 60.0]).shape == surrogate.nodes.shape


def test_without_an_obstacle_a_finger_reaches_and_refuses_to_hold(free):
    surrogate, _ = free
    finger = Finger(surrogate)
    assert finger.reach(finger.rest + surrogate.evaluate([30.0, 50.0]).tip).converged
    for attempt in (
        lambda: finger.hold(1.0, 0.01),
        lambda: finger.locate([1.0, 1.0], 1.0),
        lambda: finger.reach([0.04, 0.01, 0.0], distance=0.005),
        lambda: Gripper(surrogate),
    ):
        with pytest.raises(ValueError, match="model must have an obstacle"):
            attempt()
