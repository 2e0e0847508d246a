"""One task: close about an object whose place is not known well, lift it, turn it, put it down, let go."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from control import Flaws, Gripper, Limits
from control.grasp_controller import Grip
from control.loop import run
from control.mujoco import Simulation, plants
from rom import TouchedSegment
from studies.grasping.objects import POSE_ERROR, Thing, drawn, faced, turned
from studies.grasping.scene import STEP, simulation

PERIOD = 0.005  # of the controllers [s]
MOTOR = 200.0  # [N/s], most that a tension changes
SETTLING = 0.05  # of a finger that rings [s]
SQUEEZE = 0.3  # from touch to the held force [s]
TOLERANCE = 0.15  # of held forces [-]
MARGIN = 0.1  # likewise, before an object is dropped or crushed [-]
GENTLY = 0.4  # of the held force, with which fingers wait for each other [-]
CRUSHING = 0.02  # [s]: blows of rigid bodies that are shorter crush nothing
CLOSING = 6.0  # [s], at most
LIFT, TURN = 0.1, np.pi / 2  # [m], [rad]
PHASES = (("lift", 1.5), ("turn", 1.5), ("put down", 1.5))  # [s]
ABOVE = 0.001  # from which it is let go [m]: it may have moved by less in the gripper
OPENING = 0.6  # [s]
SLIPPED = 0.005  # [m]: an object that moved so far in the gripper is not held


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A random object at a random place, and the sensors' flaws.

    Attributes:
        thing: turned as it stands.
        error: of its pose, shape (3,) [m].
        flaws: of every finger's sensor.
        seed: of their noise.
    """

    thing: Thing
    error: np.ndarray
    flaws: Flaws
    seed: int


def trial(number: int, shape: str) -> Trial:
    """The same one for a number, every time."""
    random = np.random.default_rng([2018, number])
    thing = turned(drawn(random, shape), float(random.uniform(0, 2 * np.pi)))
    error = random.standard_normal(3)
    error *= POSE_ERROR * random.random() ** (1 / 3) / np.linalg.norm(error)
    flaws = Flaws(noise=random.uniform(0.002, 0.02), resolution=0.005, delay=int(random.integers(0, 4)), period=PERIOD)
    return Trial(thing=thing, error=error, flaws=flaws, seed=number)


@dataclass
class Watch:
    """What is seen of a simulation, pull by pull.

    Attributes:
        hardest: contact force so far, averaged over CRUSHING [N].
        peak: contact force so far, of a single step [N].
        looks: called after every period.
    """

    simulation: Simulation
    hardest: float = 0.0
    peak: float = 0.0
    looks: list[Any] = field(default_factory=list)
    _last: list[np.ndarray] = field(default_factory=list)

    def look(self) -> None:
        """At what is pressed now."""
        now = self.simulation.contact_forces()
        self._last = [*self._last[1 - round(CRUSHING / PERIOD) :], now]
        self.peak = max(self.peak, float(now.max()))
        self.hardest = max(self.hardest, float(np.mean(self._last, axis=0).max()))
        for one in self.looks:
            one(self.simulation)


@dataclass
class Closing:
    """Fingers that wait for each other, touching gently, and then squeeze together.

    Attributes:
        grips: their controllers.
        wanted: contact forces in the end, shape (fingers,) [N].
        share: of these that they are told now [-].
    """

    grips: list[Grip]
    wanted: np.ndarray
    share: float = GENTLY

    @property
    def ended(self) -> bool:
        """Whether they are told all."""
        return self.share >= 1.0

    def targets(self) -> np.ndarray:
        """Contact forces from now on, shape (fingers,) [N]."""
        if all(grip.stage == "hold" for grip in self.grips) or self.share > GENTLY:
            self.share = min(self.share + (1 - GENTLY) * PERIOD / SQUEEZE, 1.0)
        return self.share * self.wanted


def tip_height(model: TouchedSegment, radius: float, gripper: Gripper) -> float:
    """How far below the palm a free finger's plate reaches, bent to touch a face at a radius [m]."""
    segment, lead = model.segment, model.lead
    tensions = np.zeros((200, len(model.parameters) - 1))
    tensions[:, lead] = np.linspace(model.limits[0][lead], model.limits[1][lead], 200)
    placed = segment.place(np.column_stack([tensions, np.zeros((200, 6))]))
    half = segment.half_lengths
    edge = placed.centre + placed.rotation @ [half[0], half[1], 0.0]
    return float(np.interp(gripper.radius - radius + half[1], edge[:, 1], edge[:, 0]))


def attempt(model: TouchedSegment, one: Trial, looks: list[Any] | None = None, step: float = STEP) -> dict[str, Any]:
    """What becomes of it, and why."""
    gripper = Gripper(model, limits=Limits(rate=MOTOR))
    one = replace(one, thing=faced(one.thing, gripper.directions))
    thing = one.thing
    held = thing.held(gripper.directions, np.random.default_rng(0))
    known = {
        "number": one.seed,
        "shape": thing.shape,
        "mass": thing.mass,
        "friction": thing.friction,
        "admissible_force": thing.admissible_force,
        "error": float(np.linalg.norm(one.error)),
        "lean": held.lean,
    }
    wanted = gripper.targets(held, margin=MARGIN)
    if not wanted.exist:
        return known | {"fate": "refused", "reason": wanted.reason}
    return known | perform(gripper, one, wanted.contact_forces, looks or [], step)


def perform(gripper: Gripper, one: Trial, wanted: np.ndarray, looks: list[Any], step: float = STEP) -> dict[str, Any]:
    """The task with contact forces, shape (fingers,) [N]."""
    thing, model = one.thing, gripper.model
    palm = thing.grasped + tip_height(model, thing.radius, gripper) + one.error[2]
    played = simulation(model.segment, thing, palm, one.error[:2], 0.0, step)
    options = gripper.options(float(wanted.min()), one.flaws.noise, one.flaws.delay, PERIOD)
    options = replace(options, settling=SETTLING, squeeze_steps=round(SQUEEZE / PERIOD), tolerance=TOLERANCE, dead_band=TOLERANCE)
    grips = gripper.grips(GENTLY * wanted, options)
    driven = plants(played, PERIOD, one.flaws, one.seed)
    watch = Watch(played, looks=looks)

    closing = Closing(grips, wanted)

    def keep(_: int) -> np.ndarray:
        watch.look()
        return closing.targets()

    while played.time < CLOSING and not (closing.ended and all(grip.done for grip in grips)):
        run(grips, driven, 20, keep)
    found = {"targets": wanted.tolist(), "seconds": played.time, "status": [grip.status for grip in grips]}
    if any(grip.status != "converged" for grip in grips):
        fate = "crushed" if watch.hardest > thing.admissible_force else "not lifted"
        return (
            found
            | marks(played)
            | {"fate": fate, "reason": ", ".join(found["status"]), "hardest": watch.hardest, "peak": watch.peak}
        )
    before = played.data.body("object").xpos[2] - played.data.body("palm").xpos[2]
    slips, forces = {}, []
    for phase, seconds in PHASES:
        carry(played, grips, driven, phase, seconds, watch, forces)
        slips[phase] = float(before - played.data.body("object").xpos[2] + played.data.body("palm").xpos[2])
        if abs(slips[phase]) > SLIPPED:
            break
    lost = next((phase for phase, slip in slips.items() if abs(slip) > SLIPPED), "")
    fate = "crushed" if watch.hardest > thing.admissible_force else "dropped" if lost else "held"
    errors = np.abs(np.array(forces) / wanted - 1)
    return (
        found
        | marks(played)
        | {
            "fate": fate,
            "reason": f"slipped in: {lost}" if lost else "",
            "slips": slips,
            "hardest": watch.hardest,
            "peak": watch.peak,
            "force_error": float(np.percentile(errors, 95)),
        }
    )


def carry(
    played: Simulation, grips: list[Grip], driven: list, phase: str, seconds: float, watch: Watch, forces: list
) -> None:
    """One phase of the mount's way, while the fingers hold."""
    steps, mount = round(seconds / PERIOD), played.data.ctrl
    begun = mount.copy()
    aims = {"lift": {2: LIFT}, "turn": {5: TURN}, "put down": {2: ABOVE}}[phase]

    def move(k: int) -> None:
        share = (k + 1) / steps
        smooth = share**3 * (10 - 15 * share + 6 * share**2)
        for axis, aim in aims.items():
            mount[axis] = begun[axis] + smooth * (aim - begun[axis])
        forces.append(played.contact_forces())
        watch.look()

    run(grips, driven, steps, move)


def marks(played: Simulation) -> dict[str, bool]:
    """Whether anything was beyond what the map was trained for."""
    return {name: bool(getattr(played, name).any()) for name in ("left", "lost", "rubbed")}
