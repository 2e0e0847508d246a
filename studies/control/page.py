"""Write docs/control.md from what control.py measured, and its pictures.

python3 studies/control/page.py [OUT]    (out/control by default)
"""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from studies.readme import table
from studies.surrogate.page import percent

EXAMPLES = """## One finger

Every call answers with tensions [N], `status`, `residual` (distance from the target), `error` (what the model may be off there) and
`iterations`; none raises for a target that is out of reach. The examples of this page are run by the tests, one after another.

```python
import numpy as np
from control import Finger, Flaws, Gripper, Limits, Object, SimulatedPlant
from rom import Surrogate

model = Surrogate.load("out/demo/finger.h5")
finger = Finger(model, limits=Limits(upper=90.0, rate=500.0))  # [N], [N/s]
```

The first call on a machine compiles, for some seconds, unless a wheel or an image has brought what is compiled; it is kept until the
sources change. A loop that must not wait makes its first call before it starts.

`reach` brings the tip plate's centre to a point, in free space or before a plane that it must not touch. Points on the other side of the
finger are reached by the mirror images of its tendons; `sides` says which are pulled (y is mirrored in free space only).

```python
goal = finger.rest + model.evaluate([40.0, 30.0, np.inf]).tip * [1, -1, 1]  # below the finger
motion = finger.problem.reach(goal)
assert motion.status == "converged" and motion.sides == (-1, 1) and motion.residual < 1e-4  # [m]

blocked = finger.problem.reach(finger.rest + model.evaluate([60.0, 0.0, np.inf]).tip, distance=0.010)
assert blocked.status == "unreachable"  # the nearest tensions that leave the plane untouched
```

`follow` leads the tip along points, one a period, each motion from the one before and no tension faster than its motor.

```python
path = [finger.rest + model.evaluate([f, 20.0, np.inf]).tip for f in np.linspace(20, 40, 50)]
motions = finger.follow(path, period=0.01, start=[20.0, 20.0])
assert all(motion.converged for motion in motions)
assert np.abs(np.diff([motion.tensions for motion in motions], axis=0)).max() <= 5.0  # [N] a period
```

`locate` finds the plane from tensions and the contact force felt, one reading or many; `deviation` is the standard deviation of d* by the
sensor's noise and the model's error.

```python
felt = model.evaluate([50.0, 10.0, 0.012]).contact_force  # what a sensor would say
found = finger.locate([50.0, 10.0], felt, noise=0.01)
assert abs(found.distance - 0.012) < 1e-6 and 0 < found.deviation < 1e-4  # [m]
```

`hold` presses with a contact force on a plane at a distance. Of all tensions that do, those nearest to the present ones are taken.

```python
held = finger.hold(contact_force=1.0, distance=found.distance, start=[50.0, 10.0])
assert held.converged and held.error < 0.01  # [N]
assert finger.hold(contact_force=50.0, distance=0.012).status == "unreachable"
assert finger.hold(contact_force=1.0, distance=0.2).status == "out_of_domain"
```

A model whose scene stores the pad's pressure (`sampling.store = ["pad_pressure"]`) holds that too, and can be limited to what an object
bears: where the pad would press harder, the motion is `unreachable` and holds what is allowed (`tests/fingerfem/snapshots/test_pad.py`).

```py
finger = Finger(model_with_pad, limits=Limits(pad_pressure=8e4))  # [Pa]
finger.hold(pad_pressure=5e4, distance=0.010)
```

## A gripper

Three fingers around an object of unknown place and size: they close, feel, find, squeeze and hold. `targets` says which contact forces
neither drop an object (its weight, carried by friction) nor crush it, or why there are none.

```python
gripper = Gripper(model, fingers=3, radius=0.025, limits=Limits(rate=500.0))
egg = Object(mass=0.06, friction=0.5, admissible_force=3.0, down=(1.0, 0.0, 0.0))  # hanging down
targets = gripper.targets(egg)
assert targets.exist and targets.least < targets.contact_forces[0] < targets.most
stone = Object(mass=2.0, friction=0.3, admissible_force=5.0)
print(gripper.targets(stone).reason)

flaws = Flaws(noise=0.01, resolution=0.005, delay=3, force_error=0.05)  # of sensors and model
options = gripper.options(targets.contact_forces.min(), noise=0.01, delay=3)
plants = [SimulatedPlant(model, d, flaws, seed=i) for i, d in enumerate(gripper.distances([0.002, -0.001], 0.012))]
grasp = gripper.grasp(targets.contact_forces, plants, options)
assert grasp.converged and np.allclose(grasp.contact_forces, targets.contact_forces, rtol=0.03)
print(grasp.centre, grasp.radius, "m")
```

A plant is whatever has `pull(tensions)` and returns the contact force felt; one whose readings come late also has `age` [s].
`fingerfem.full_order_plant.FullOrderPlant` is the full-order model as one. `control.loop.run` drives controllers at a rate, whatever the plants do, and
reports how much of a period they took, what they missed and what happened:

```python
from control.loop import run
from control.plant import Dead, Slipping

broken = [Slipping(plants[0], tendon=0, share=0.8, begin=500), Dead(plants[1], begin=600), plants[2]]
report = run(gripper.grips(1.0, options), broken, periods=900)
print(f"{report.share:.0%} of the period (p99), {report.missed} missed, {report.status}")
assert report.status == ["converged", "sensor_failed", "converged"]  # the dead finger's tensions stay
assert (608 < report.events[-1][0] < 650) and report.events[-1][2] == "blind"
```

## For learning

`pip install -e '.[gymnasium]'`; the environment passes gymnasium's checker.

```python
from control.environment import HoldEnvironment

environment = HoldEnvironment(model, targets=(0.5, 3.0))  # [N]
observation, known = environment.reset(seed=1)
observation, reward, crushed, over, _ = environment.step(np.array([1.0, 0.0]))
```
"""


def campaigns(found: dict) -> str:
    """Solves by scene and kind of start."""
    header = ["scene", "starts", "converged", "unreachable", "wrong by dense search", "out of limits", "evaluations"]
    header += ["mean us", "p99 us", "Python's call, p99 us", "paper, mean us"]
    rows = []
    for name, kinds in found["campaigns"].items():
        for kind, label in (("random", "random"), ("sweep", "authors' sweep")):
            one = kinds[kind]
            rows.append(
                [
                    name,
                    f"{one['starts']:,} {label}",
                    f"{one['converged']:,}",
                    f"{one['unreachable']:,}",
                    str(one["dense_search"]["wrong"]),
                    str(one["out_of_limits"]),
                    f"{one['mean_iterations']:.1f}",
                    f"{one['mean_us']:.1f}",
                    f"{one['p99_us']:.0f}",
                    f"{one['call_p99_us']:.0f}",
                    f"{found['paper_us'][name]:,.0f}",
                ]
            )
    return table(header, rows)


def held(found: dict) -> str:
    """Held forces by the full-order model."""
    header = ["scene", "answers", "error, median", "95 %", "largest", "within what was said", "tip, median"]
    rows = [
        [
            name,
            str(one["cases"] - one["not_solved"]),
            percent(one["median"]),
            percent(one["p95"]),
            percent(one["max"]),
            str(one["within_said"]),
            percent(one["tip_median"]),
        ]
        for name, one in found["verification"].items()
    ]
    return table(header, rows)


def page(found: dict) -> str:
    """The whole page."""
    grasps, loop = found["grasps"], found["loop"]
    return f"""# Control: reach, feel, hold, grasp

Written by `python3 studies/control/page.py`; numbers by `python3 studies/control/control.py` (`make control`), on one core of the machine that wrote
this.

{EXAMPLES}
## How it solves

`control/native/least_squares.c` is a bounded Levenberg-Marquardt, without allocation, with a fixed limit of evaluations. Before touch
the contact force is zero whatever the tensions; the gap, times the stiffness of contact, takes its place. Where many tensions hold one
force, it goes on along them to those nearest to the present ones (to 6 degrees). If a start leads nowhere, it begins again at points of an atlas,
a grid of the model's answers that a `Finger` keeps: so `unreachable` means that the whole box was looked at.

Holding {
        found[
            "target"
        ]:g} N from random starts at random distances, and the authors' sweep (100 distances times 100 starts of the lead
tendon). A dense search ({
        next(iter(found["campaigns"].values()))["random"]["dense_search"]["grid"]:,} points, and bisection along every
edge of their grid that crosses the target) looks for what is called unreachable.

{campaigns(found)}

The paper's times are of its table 1 (Chenevier et al., PLoS ONE 2018), on another machine.

## Fed to the full-order model

Answers held from random starts, at random distances, for random contact forces of 0.25 to 4 N, without any feedback: solved again by the
full-order model from rest.

{held(found)}

![Held against wanted, and errors by distance](control.png)

## At 1 kHz

Three fingers with a noise of 10 mN, readings rounded to 5 mN and 3 ms late, and forces 5 % larger than the model's. The controllers take
{100 * loop["share"]:.1f} % of a period (p99; {loop["p50_us"]:.0f} us median, {loop["p99_us"]:.0f} us p99, {
        loop["p999_us"]:.0f} us p99.9);
{loop["missed"]} of {loop["periods"]:,} periods were missed.

![A target that jumps, a tendon that slips, a sensor that dies](loop.png)

## A thousand grasps

Objects of 10 to 300 g, friction 0.3 to 1, crushed at 0.5 to 6 N, up to 4 mm off the centre, of 8 to 18 mm radius, hanging any way; noise
of 2 to 20 mN, 0 to 5 ms of delay, 5 mN resolution, forces 5 % off the model's, a different way for each finger. When all fingers hold, the object is
lifted; dropped means that friction at the true forces does not carry it, crushed that a true force was ever above what it bears.

{
        table(
            ["grasps", "held", "dropped", "crushed", "not lifted", "out of the fingers' reach", "no targets exist"],
            [
                [
                    f"{grasps[key]:,}"
                    for key in ("grasps", "held", "dropped", "crushed", "not_lifted", "out_of_reach", "refused")
                ]
            ],
        )
    }

It takes {grasps["seconds_median"]:.2f} s (median) until all hold; held forces then stay within {
        percent(grasps["force_error_max"])
    } of
their targets at worst. A refusal says why, for instance: "{grasps["reasons"][0] if grasps["reasons"] else "none"}".
"""


def main(folder: Path) -> None:
    """Write the page, copy the pictures."""
    found = json.loads((folder / "control.json").read_text())
    (ROOT / "docs" / "control.md").write_text(page(found))
    shutil.copy(folder / "one-segment" / "verification.png", ROOT / "docs" / "control.png")
    shutil.copy(folder / "loop.png", ROOT / "docs" / "loop.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out" / "control")
