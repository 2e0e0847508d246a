"""One task: close about a solid whose position is uncertain, lift it, turn it, put it down, open."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from control import Limits
from control.grasping.grasp_forces import GRAVITY, Targets
from control.loop import run
from control.mujoco import plants
from control.mujoco.layouts import FINGERS, Layout, best_layout
from control.mujoco.solids import POSE_ERROR, Solid
from control.mujoco.table import STEP, closing_at, table
from rom import TouchedSegment
from studies.grasping.approach import LOWERING, bend, feel_table, yield_to
from studies.grasping.closing import GENTLY, SQUEEZE, Closing
from studies.grasping.hand import TOGETHER, Hand, Look
from studies.grasping.trials import PERIOD, Trial

MOTOR = 200.0  # [N/s], most that a tension changes
SETTLING = 0.05  # of a finger that rings [s]
TOLERANCE = 0.15  # of held forces: a free object balances them among fingers as it likes [-]
# Errors of the gripper's position once it has felt the table and yielded, along x, y, z, that a plan includes [m].
FOUND = (0.0015, 0.0015, 0.001)
# Errors of forces before anything is dropped or crushed [-]. Fingers slide from face to face of a mesh: forces jump.
MARGINS = {"mesh": 0.3}
MARGIN = 0.2  # of other shapes [-]
CLOSING = 6.0  # [s], at most
CLEAR = 0.0005  # distance of fingers from the table [m]
LIFT, TURN = 0.1, np.pi / 2  # [m], [rad]
# Phases: name, axis of the arm, its goal [m, rad], and duration [s]. A weight bends fingers straighter,
# which takes contact force away: so slowly that the controllers follow.
PHASES = (
    ("take its weight", 2, 0.003, 1.0),
    ("lift", 2, LIFT, 1.5),
    ("turn", 5, TURN, 1.5),
    ("bring it down", 2, 0.01, 1.5),
)
SLIPPED = 0.005  # [m]: a solid that moved so far in the gripper is not held


def attempt(model: TouchedSegment, one: Trial, looks: list[Look] | None = None) -> dict[str, Any]:
    """The outcome of a trial, `fate`, and its reason; a row of plain numbers.

    It is refused (before anything moves: no contact force would neither drop nor crush the solid), let go (before the
    solid is lifted), held, dropped, or crushed.
    """
    layout = planned(model, one)
    solid, wanted = layout.solid, layout.targets
    row: dict[str, Any] = {name: getattr(solid, name) for name in ("shape", "mass", "friction", "admissible_force")}
    row |= {"number": one.number, "fingers": len(layout.gripper.fingers), "room": layout.room}
    row |= {"bound": max(FINGERS) * solid.capacity * solid.admissible_force / (solid.mass * GRAVITY)}
    row |= {
        "margin": 1 + margin_of(solid),
        "tipping": solid.tipping_force,
        "rolled": one.rolled,
        "planned": max(FOUND[:2]),
    }
    refused = refusal(one, solid, wanted)
    if refused:
        return row | {"fate": "refused", "reason": refused}
    hand = over(model, one, layout, looks)
    row |= perform(hand, one, layout)
    if hand.hardest > solid.admissible_force:
        row |= {"fate": "crushed", "reason": f"{hand.hardest:.3g} N on {solid.admissible_force:.3g} N"}
    marks = {name: bool(getattr(hand.simulation, name).any()) for name in ("left", "lost")}
    return row | marks | {"hardest": hand.hardest, "hardest_in": hand.hardest_in}


def planned(model: TouchedSegment, one: Trial) -> Layout:
    """The layout for a trial."""
    return best_layout(model, replace(one.solid, uncertain=FOUND), Limits(rate=MOTOR), margin_of(one.solid))


def margin_of(solid: Solid) -> float:
    """Error of forces that a plan admits on both sides [-]."""
    return MARGINS.get(solid.shape, MARGIN)


def refusal(one: Trial, solid: Solid, wanted: Targets) -> str:
    """Why a solid is not to be touched; empty if there is no reason."""
    if not wanted.exist:
        return wanted.reason
    if wanted.contact_forces.min() < one.least_felt:
        return f"{wanted.contact_forces.min():.2g} N cannot be distinguished from no contact"
    weight, hardest = solid.mass * GRAVITY, float(wanted.contact_forces.max())
    if solid.tipping_force < one.least_felt and weight + hardest > solid.admissible_force:
        return f"a touch tips it over: {weight:.3g} N may lean on a finger that presses with {hardest:.3g} N"
    return ""


def over(model: TouchedSegment, one: Trial, layout: Layout, looks: list[Look] | None = None) -> Hand:
    """The hand above a solid on a table."""
    simulation = table(layout.gripper, model.rod, layout.solid, one.error, layout.turn, STEP)
    driven = plants(simulation, PERIOD, one.flaws, one.number)
    return Hand(layout.gripper, model.rod, simulation, driven, looks or [])


def perform(hand: Hand, one: Trial, layout: Layout) -> dict[str, Any]:
    """The task: its fate but for crushing, why, and times, errors and slips."""
    height, table_error = approach(hand, one, layout)
    closing = close(hand, one, layout)
    row: dict[str, Any] = {"closing_seconds": hand.simulation.time, "table_error": table_error}
    row |= {"again": bool(np.isinf(closing.planned)), "sticks": any(grip.status == "sticks" for grip in closing.grips)}
    row |= {"beside": hand.beside(), "tilted": hand.tilt()}
    doubt = closing.doubt or closing.failed()
    if not doubt:
        begun, slips, first = hand.below(), {}, len(hand.forces)
        for phase, axis, aim, seconds in PHASES:
            hand.phase = phase
            # up to 3 mm above the table, it may be let go
            doubt_now = closing.doubt_now if phase == PHASES[0][0] else str
            hand.carry(closing.grips, axis, aim + height * (axis == 2), seconds, doubt_now)
            slips[phase] = begun - hand.below()
            doubt = doubt_now()
            if doubt:
                break
            if abs(slips[phase]) > SLIPPED:
                return row | {"fate": "dropped", "reason": f"slipped when the arm was to {phase}", "slips": slips}
        row |= {"slips": slips}
    if doubt:
        hand.release(np.array([grip.tensions for grip in closing.grips]))
        return row | {"fate": "let go", "reason": doubt}
    errors = np.abs(np.array(hand.forces[first:]) / layout.targets.contact_forces - 1)
    row |= {"force_error": float(np.percentile(errors, 95))}
    hand.phase = "put it down"
    hand.put_down(closing.grips, height)
    return row | {"fate": "held", "reason": "", "tilt": hand.tilt()}


def approach(hand: Hand, one: Trial, layout: Layout) -> tuple[float, float]:
    """Bend the fingers beside the solid, at the height of the grasp; return the arm's height and its error [m]."""
    gripper, solid = layout.gripper, layout.solid
    beside = solid.turned(layout.turn).reach(gripper.directions) + POSE_ERROR
    _, plate, end = closing_at(gripper, hand.rod, solid.radius)
    longest = max(end, *(closing_at(gripper, hand.rod, one)[2] for one in np.linspace(solid.radius, beside, 5)))
    felt = feel_table(hand, one.least_felt)
    height = felt + max(solid.grasped + plate, longest + CLEAR)
    bend(hand, beside, height)
    return height, abs(felt - hand.on_table())


def close(hand: Hand, one: Trial, layout: Layout) -> Closing:
    """Close; where a gentle touch locates the solid farther from the axis than planned, close again about its centre.

    A solid aside is squeezed by fingers of different lengths: their contact points differ in height, and it tips.
    """
    bent, height = hand.simulation.wanted.copy(), float(hand.mount[2])
    closing = closed(hand, one, layout, planned=max(FOUND[:2]))
    if closing.again:
        hand.open(hand.simulation.wanted.copy(), bent)
        centre = closing.centre * min(1.0, POSE_ERROR / float(np.linalg.norm(closing.centre)))
        hand.move(np.append(hand.mount[:2] + centre, height), LOWERING)
        closing = closed(hand, one, layout)
    return closing


def closed(hand: Hand, one: Trial, layout: Layout, planned: float = np.inf) -> Closing:
    """Close until all fingers hold their contact forces, one has given up, or it takes too long.

    Fingers that locate the solid farther from the axis than planned [m] do not squeeze.
    """
    gripper, solid, wanted = layout.gripper, layout.solid, layout.targets.contact_forces
    share = max(GENTLY, one.least_felt / float(wanted.min()))
    options = gripper.options(float(wanted.min()), one.flaws.noise, one.flaws.delay, PERIOD, TOLERANCE)
    options = replace(options, settling=SETTLING, squeeze_steps=round(SQUEEZE / PERIOD), dead_band=TOLERANCE)
    closing = Closing(
        gripper=gripper,
        grips=gripper.grips(share * wanted, options),
        wanted=wanted,
        most=solid.admissible_force,
        half_widths=solid.turned(layout.turn).half_widths(gripper.directions),
        uncertain=1.5 * POSE_ERROR,
        off_centre=POSE_ERROR,
        planned=planned,
        share=share,
    )
    for grip, tensions in zip(closing.grips, hand.simulation.wanted, strict=True):
        grip.tensions = tensions.copy()
    gently, begun = share * float(wanted.mean()), hand.simulation.time

    def targets(_: int) -> list[float]:
        hand.look()
        if not all(any(name == "touch" for _, name in grip.events) for grip in closing.grips):
            yield_to(hand, closing.grips, gently)
        return closing.targets().tolist()

    while hand.simulation.time < begun + CLOSING and not closing.ended:
        run(closing.grips, hand.driven, TOGETHER, targets)
    return closing
