"""One task: close about a solid whose place is not known well, lift it, turn it, put it down, let go."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from control import Flaws, Gripper, Limits
from control.grasping.grasp_controller import DISTINCT, GraspOptions, Grip
from control.grasping.grasp_forces import GRAVITY
from control.loop import run
from control.mujoco import MujocoPlant, Simulation, plants
from control.mujoco.layouts import FINGERS, best_layout
from control.mujoco.resting import at_rest
from control.mujoco.solids import POSE_ERROR, Solid, random_error, random_solid
from control.mujoco.table import STEP, table, tip_height
from rom import TouchedSegment
from studies.grasping.approach import Approach, yield_to
from studies.grasping.closing import GENTLY, SQUEEZE, Closing

PERIOD = 0.005  # of the controllers [s]
MOTOR = 200.0  # [N/s], most that a tension changes
SETTLING = 0.05  # of a finger that rings [s]
TOLERANCE = 0.15  # of held forces: a free object balances them among fingers as it likes [-]
# Errors of the gripper's position once it has felt the table and yielded, along x, y, z, that a plan includes [m].
FOUND = (0.0015, 0.0015, 0.001)
MARGIN = 0.2  # that forces may be off before anything is dropped or crushed [-]
CRUSHING = 0.02  # [s]: blows of rigid bodies that are shorter crush nothing
CLOSING = 6.0  # [s], at most
LIFT, TURN = 0.1, np.pi / 2  # [m], [rad]
FELT = 0.15  # of the held force: a change by so much is the table's, when it is put down [-]
# Phases: name, axis of the mount, its goal [m, rad], and duration [s]. A weight bends fingers straighter,
# which takes contact force away: so slowly that the controllers follow.
PHASES = (
    ("take its weight", 2, 0.003, 1.0),
    ("lift", 2, LIFT, 1.5),
    ("turn", 5, TURN, 1.5),
    ("bring it down", 2, 0.01, 1.5),
)
SLOWLY = 0.005  # [m/s], from there on, until the table is felt
# Fingers that let go become longer: so it is let go where it cannot be pressed on the table.
CLEAR, CLEARING, OPENING = 0.002, 0.2, 0.6  # how far above it [m]; how long that and opening take [s]
SLIPPED = 0.005  # [m]: a solid that moved so far in the gripper is not held
Look = Callable[[Simulation], None]


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A random solid, the error of the gripper's position, shape (3,) [m], and the flaws of every finger's sensor."""

    number: int
    solid: Solid
    error: np.ndarray
    flaws: Flaws


def trial(number: int, shape: str) -> Trial:
    """The same one for a number, every time."""
    random = np.random.default_rng([2018, number])
    solid = at_rest(random_solid(random, shape))
    error = random_error(random)
    flaws = Flaws(noise=random.uniform(0.002, 0.02), resolution=0.005, delay=int(random.integers(0, 4)), period=PERIOD)
    return Trial(number=number, solid=solid, error=error, flaws=flaws)


@dataclass
class Watch:
    """Contact forces of a simulation, shapes (fingers,) [N], and the largest, averaged over CRUSHING; calls `looks`."""

    simulation: Simulation
    looks: list[Look]
    hardest: float = 0.0
    forces: list[np.ndarray] = field(default_factory=list)

    def look(self) -> None:
        """At what is pressed now."""
        self.forces.append(self.simulation.contact_forces())
        lately = self.forces[-round(CRUSHING / PERIOD) :]
        self.hardest = max(self.hardest, float(np.mean(lately, axis=0).max()))
        self.show()

    def show(self) -> None:
        """Call what looks."""
        for one in self.looks:
            one(self.simulation)


def attempt(model: TouchedSegment, one: Trial, looks: list[Look] | None = None) -> dict[str, Any]:
    """The outcome of a trial, `fate`, and its reason; a row of plain numbers.

    It is refused (before anything moves: no contact force would neither drop nor crush the solid), let go (before the
    solid is lifted), held, dropped, or crushed.
    """
    gripper, solid, turn, wanted = best_layout(model, replace(one.solid, uncertain=FOUND), Limits(rate=MOTOR), MARGIN)
    row: dict[str, Any] = {name: getattr(solid, name) for name in ("shape", "mass", "friction", "admissible_force")}
    row |= {"number": one.number, "fingers": len(gripper.fingers), "room": wanted.most / wanted.least}
    row |= {"bound": max(FINGERS) * solid.capacity * solid.admissible_force / (solid.mass * GRAVITY)}
    row |= {"margin": 1 + MARGIN, "tipping": solid.tipping_force}
    if not wanted.exist:
        return row | {"fate": "refused", "reason": wanted.reason}
    if wanted.contact_forces.min() < least_felt(one):
        reason = f"{wanted.contact_forces.min():.2g} N cannot be distinguished from no contact"
        return row | {"fate": "refused", "reason": reason}
    weight, hardest = solid.mass * GRAVITY, float(wanted.contact_forces.max())
    if solid.tipping_force < least_felt(one) and weight + hardest > solid.admissible_force:
        reason = f"a touch tips it over: {weight:.3g} N may lean on a finger that presses with {hardest:.3g} N"
        return row | {"fate": "refused", "reason": reason}
    one = replace(one, solid=solid)
    watch = Watch(table(gripper, model.rod, solid, one.error, turn, STEP), looks or [])
    driven = plants(watch.simulation, PERIOD, one.flaws, one.number)
    palm = solid.grasped + tip_height(gripper, model.rod, solid.radius)
    approach = Approach(gripper, model.rod, watch.simulation, driven, PERIOD, palm, watch.show)
    approach.begin()
    approach.feel_table(least_felt(one))
    row |= {"table_error": approach.table + float(watch.simulation.data.body("palm").xpos[2] - watch.simulation.data.joint("z").qpos[0])}
    bent = approach.bend(solid.turned(turn).reach(gripper.directions) + POSE_ERROR, solid.radius)
    row |= perform(gripper, one, wanted.contact_forces, driven, bent, watch)
    if watch.hardest > solid.admissible_force:
        row |= {"fate": "crushed", "reason": f"{watch.hardest:.3g} N on {solid.admissible_force:.3g} N"}
    marks = {name: bool(getattr(watch.simulation, name).any()) for name in ("left", "lost")}
    return row | marks | {"hardest": watch.hardest}


def least_felt(one: Trial) -> float:
    """Smallest contact force that a finger distinguishes from none [N]."""
    return 1.05 * DISTINCT * max(GraspOptions().feel, 3 * one.flaws.noise)


def perform(
    gripper: Gripper, one: Trial, wanted: np.ndarray, driven: list[MujocoPlant], bent: np.ndarray, watch: Watch
) -> dict[str, Any]:
    """The task with contact forces, shape (fingers,) [N]: its fate but for crushing, why, and times and slips."""
    simulation = watch.simulation
    closing = close(gripper, one, wanted, driven, bent, watch)
    off = simulation.data.body("object").xpos[:2] - simulation.data.body("palm").xpos[:2]
    row: dict[str, Any] = {"closing_seconds": simulation.time, "off": float(np.linalg.norm(off)), "tilted": tilt(simulation)}
    doubt = closing.doubt or closing.failed()
    if doubt:
        return row | {"fate": "let go", "reason": doubt}
    begun, slips, first = below(simulation), {}, len(watch.forces)
    height = float(simulation.data.ctrl[2])
    for phase, axis, aim, seconds in PHASES:
        carry(closing.grips, driven, axis, aim + height * (axis == 2), seconds, watch)
        slips[phase] = begun - below(simulation)
        if phase == PHASES[0][0] and any(grip.done and grip.status != "converged" for grip in closing.grips):
            return row | {"fate": "let go", "reason": closing.failed(), "slips": slips}  # 3 mm above the table
        if abs(slips[phase]) > SLIPPED:
            return row | {"fate": "dropped", "reason": f"slipped when it was to {phase}", "slips": slips}
    errors = np.abs(np.array(watch.forces[first:]) / wanted - 1)
    row |= {"slips": slips, "force_error": float(np.percentile(errors, 95))}
    put_down(closing.grips, driven, height, watch)
    return row | {"fate": "held", "reason": "", "tilt": tilt(simulation)}


def close(
    gripper: Gripper, one: Trial, wanted: np.ndarray, driven: list[MujocoPlant], bent: np.ndarray, watch: Watch
) -> Closing:
    """Close until all fingers hold contact forces, shape (fingers,) [N], one has given up, or it takes too long."""
    share = max(GENTLY, least_felt(one) / float(wanted.min()))
    options = gripper.options(float(wanted.min()), one.flaws.noise, one.flaws.delay, PERIOD, TOLERANCE)
    options = replace(options, settling=SETTLING, squeeze_steps=round(SQUEEZE / PERIOD), dead_band=TOLERANCE)
    closing = Closing(
        gripper=gripper,
        grips=gripper.grips(share * wanted, options),
        wanted=wanted,
        radius=one.solid.radius,
        uncertain=2 * POSE_ERROR,
        off_centre=1.5 * POSE_ERROR,
        share=share,
    )

    for grip in closing.grips:
        grip.tensions = bent.copy()
    gently = share * float(wanted.mean())

    def targets(_: int) -> list[float]:
        watch.look()
        if not closing.squeezing:
            yield_to(gripper, closing.grips, gently, watch.simulation.data.ctrl)
        return closing.targets().tolist()

    while watch.simulation.time < CLOSING and not closing.ended:
        run(closing.grips, driven, 20, targets)
    return closing


def carry(grips: list[Grip], driven: list[MujocoPlant], axis: int, aim: float, seconds: float, watch: Watch) -> None:
    """Move one axis of the mount smoothly to where it is to be [m, rad], while the fingers hold."""
    steps, mount = round(seconds / PERIOD), watch.simulation.data.ctrl
    begun = float(mount[axis])

    def move(k: int) -> None:
        share = (k + 1) / steps
        mount[axis] = begun + share**3 * (10 - 15 * share + 6 * share**2) * (aim - begun)
        watch.look()

    run(grips, driven, steps, move)


def put_down(grips: list[Grip], driven: list[MujocoPlant], height: float, watch: Watch) -> None:
    """Go down slowly until the table is felt, a little up, and open.

    The tensions stay on the way: on the table what is held sticks, and whoever pulls less presses harder at first.
    """
    simulation, held = watch.simulation, np.array([grip.felt for grip in grips])
    mount, felt = simulation.data.ctrl, held
    while mount[2] > height and np.abs(felt - held).max() < FELT * held.mean():
        mount[2] -= SLOWLY * PERIOD
        felt = np.array([plant.pull(grip.tensions) for grip, plant in zip(grips, driven, strict=True)])
        watch.look()
    mount[2] += CLEAR
    rest = [np.zeros_like(grip.tensions) for grip in grips]
    for tensions, seconds in (([grip.tensions for grip in grips], CLEARING), (rest, OPENING)):
        for finger, pulled in enumerate(tensions):
            simulation.pull(finger, pulled)
        for _ in range(round(seconds / PERIOD)):
            simulation.advance(simulation.time + PERIOD)
            watch.look()


def below(simulation: Simulation) -> float:
    """Distance of the solid's origin below the palm's [m]."""
    data = simulation.data
    return float(data.body("object").xpos[2] - data.body("palm").xpos[2])


def tilt(simulation: Simulation) -> float:
    """Angle between the solid's axis and the vertical [rad]."""
    return float(np.arccos(np.clip(simulation.data.body("object").xmat[8], -1, 1)))
