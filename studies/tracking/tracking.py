"""Errors of a tip that follows circles and figures of eight, by PIDs of tensions and by the tracking controller."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from control import Flaws, Limits, MovingPlant, TrackingController, TrackingOptions, run
from control.loop import Controller
from control.tracking import PidController, circle, eight
from control.tracking.plan import Plan, planned
from rom import MovingFinger, TouchedSegment
from studies.parts import Run

PERIOD, STEPS = 2e-3, 4  # [s]; of time in a period: twice as many as in the controller's simulation
CENTRE, RADIUS = np.zeros(2), 0.010  # of the paths [m]
RATES, LAPS = (1.0, 2.0, 4.0), 1.5  # [Hz]; the first is not counted
DISTANCE = 0.007  # of the plane [m]
FORCE, MARGIN = 0.4, 5e-4  # options most_force [N] and margin [m], and a smaller force:
LOW_FORCE, LOW_MARGIN = 0.1, 1e-4
FRICTION = 0.2  # coefficient of the tendons in their guides [-]
LATE, NOISE = 2, 2e-5  # periods; of the tip's readings [m]
RELAXING = [[0.1, 0.005], [0.1, 0.1]]  # branches of the rubber: moduli over the law's own [-], and times [s]
LOOSE = 0.05  # pretension of the PID and the inverse, whose errors are smaller with less [-]
GAINS = tuple(product((0.0, 0.3, 0.6), (1.0, 4.0, 10.0), (0.0, 0.01, 0.02)))  # proportional, integral, derivative


@dataclass(frozen=True, kw_only=True)
class Case:
    """A path, where the plane is, and how the finger differs from the controller's model.

    Attributes:
        name: for the table.
        shape: of the path.
        distance: of the plane [m].
        force, margin: options most_force [N] and margin [m].
        delay: of readings, in periods.
        noise: of the tip's readings [m].
        modulus: over the model's [-].
        density: likewise of the rubber [-].
        friction: of the tendons in their guides [-].
        compensated: the same in the controller's options [-].
        relaxes: whether the rubber relaxes.
    """

    name: str
    shape: Callable[..., np.ndarray] = circle
    distance: float = np.inf
    force: float = FORCE
    margin: float = MARGIN
    delay: int = 0
    noise: float = 0.0
    modulus: float = 1.0
    density: float = 1.0
    friction: float = 0.0
    compensated: float = 0.0
    relaxes: bool = True


BEFORE, STIFFER, SOFTER = "circle, before a plane", "stiffer and lighter, noise", "softer and heavier, noise"
LATER = Case(name="circle, free, readings 4 ms late", delay=LATE)
PLANE = Case(name=f"{BEFORE}, readings 4 ms late", distance=DISTANCE, delay=LATE)
NOISY = replace(LATER, noise=NOISE, modulus=1.1, density=0.9)
RUBBING = replace(LATER, friction=FRICTION)
CASES = (
    Case(name="circle, free"),
    LATER,
    replace(LATER, name="figure of eight, 4 ms late", shape=eight),
    replace(PLANE, name=BEFORE, delay=0),
    PLANE,
    replace(PLANE, name=f"{BEFORE}, 5 % {STIFFER}, 4 ms late", noise=NOISE, modulus=1.05, density=0.95),
    replace(PLANE, name=f"{BEFORE}, 10 % {STIFFER}, 4 ms late", noise=NOISE, modulus=1.1, density=0.9),
    replace(PLANE, name=f"{BEFORE}, 10 % {SOFTER}, 4 ms late", noise=NOISE, modulus=0.9, density=1.1),
    replace(PLANE, name=f"{BEFORE}, at most {LOW_FORCE:g} N, 4 ms late", force=LOW_FORCE, margin=LOW_MARGIN),
    replace(NOISY, name=f"circle, 10 % {STIFFER}, 4 ms late"),
    replace(NOISY, name=f"circle, 10 % {SOFTER}, 4 ms late", modulus=0.9, density=1.1),
    replace(LATER, name="circle, elastic, 4 ms late", relaxes=False),
    replace(RUBBING, name="circle, friction of 0.2, 4 ms late, not compensated"),
    replace(RUBBING, name="circle, friction of 0.2, 4 ms late, compensated", compensated=FRICTION),
    replace(RUBBING, name="circle, friction of 0.2, 4 ms late, compensated as 0.15", compensated=0.15),
)


class Stopping(MovingPlant):
    """A moving finger that stops when it has left the domain of its elements."""

    left = False

    def pull(self, tensions: ArrayLike) -> float:
        """See `control.Plant`."""
        if self.left:
            raise ValueError("the finger must stay in its domain, got one that left it")
        self.left = True
        felt = super().pull(tensions)
        self.left = False
        return felt


@cache
def round_finger(relaxes: bool) -> TouchedSegment:
    """The bundled round finger, whose rubber relaxes or is elastic."""
    model = TouchedSegment.load("round")
    material = model.scene["material"] | ({"prony": RELAXING} if relaxes else {})
    return replace(model, rod=model.rod.assembled(model.scene | {"material": material}))


def changed(model: TouchedSegment, case: Case) -> TouchedSegment:
    """The finger of a case; its tensions are at most those that its elements were trained for."""
    if case.modulus == case.density == 1.0:
        return model
    scene, material = model.scene, dict(model.scene["material"])
    material |= {name: case.modulus * material[name] for name in ("C1", "C2", "C3")}
    material["D1"] /= case.modulus
    tendons = [one | {"tension": [0.0, one["tension"][1] * min(case.modulus, 1.0)]} for one in scene["tendons"]]
    gravity = scene["gravity"] | {"density": case.density * scene["gravity"]["density"]}
    tables = scene | {"material": material, "tendons": tendons, "gravity": gravity}
    return replace(model, rod=model.rod.assembled(tables))


def followed(
    model: TouchedSegment, case: Case, controller: Controller, plan: Plan, rate: float, goals: np.ndarray
) -> dict | None:
    """Errors [m], forces [N] and times [us] after the first lap; None if the finger left its domain."""
    flaws = Flaws(period=PERIOD, delay=case.delay, tip_noise=case.noise, friction=case.friction)
    plant = Stopping(model, case.distance, flaws=flaws, steps=STEPS, tensions=plan.tensions[0])
    found = run([controller], [plant], len(goals) - 1)
    if found.unread:
        return None
    errors = found.errors(goals)[round(1 / rate / PERIOD) :]
    return {
        "rms_m": float(np.sqrt((errors**2).mean())),
        "largest_m": float(errors.max()),
        "force_N": float(found.contact_forces.max()),
        "us": found.p50_us,
    }


def tuned(delay: int) -> tuple[float, float, float]:
    """The PID's gains with the least error in a free circle at the middle rate."""
    model, rate, case, options = (
        round_finger(True),
        RATES[1],
        Case(name="", delay=delay),
        TrackingOptions(period=PERIOD, pretension=LOOSE),
    )
    path = circle(CENTRE + model.rod.rest[1:], RADIUS, rate, PERIOD, LAPS)
    plan = planned(model, path, None, options, Limits())

    def error(gains: tuple[float, float, float]) -> float:
        found = followed(model, case, PidController(model, path, gains, options), plan, rate, plan.tips)
        return np.inf if found is None else found["rms_m"]

    return min(GAINS, key=error)


def posed(case: Case, rate: float) -> tuple[TouchedSegment, np.ndarray, TrackingOptions]:
    """The controller's model, the path of a case, and options."""
    model = round_finger(case.relaxes)
    path = case.shape(CENTRE + model.rod.rest[1:], RADIUS, rate, PERIOD, LAPS)
    options = TrackingOptions(
        period=PERIOD, distance=case.distance, friction=case.compensated, most_force=case.force, margin=case.margin
    )
    return model, path, options


@cache
def led(case: Case, rate: float) -> TrackingController:
    """The controller of a case; cached by what it depends on, see `planned_for`."""
    return TrackingController(*posed(case, rate))


def planned_for(case: Case) -> Case:
    """The case without properties that the plan does not depend on."""
    return replace(case, name="", delay=0, noise=0.0, modulus=1.0, density=1.0, friction=0.0)


@cache
def goals(case: Case, rate: float) -> np.ndarray:
    """The path, or the surface of the plane in front of it: `tips` of the controller's plan."""
    model, path, options = posed(case, rate)
    return planned(model, path, None, options, Limits()).tips


@cache
def without_tracking(case: Case, gains: tuple[float, float, float]) -> list[dict]:
    """Errors of a PID of tensions, and of the same with the inverse of the model at rest, at every rate."""
    rates = []
    for rate in RATES:
        model, path, given = posed(case, rate)
        options, tips = replace(given, distance=np.inf, pretension=LOOSE), goals(planned_for(case), rate)
        plan, found = planned(model, path, None, options, Limits()), {}
        for name, pulled in (("pid", None), ("inverse", plan.tensions)):
            pid = PidController(model, path, gains, options, pulled=pulled)
            found[name] = followed(changed(model, case), case, pid, plan, rate, tips)
        rates.append(found)
    return rates


def compared(case: Case, gains: tuple[float, float, float]) -> list[dict]:
    """The same of a case; the cache serves cases that differ in options of the tracking controller."""
    return without_tracking(replace(case, name="", compensated=0.0), gains)


def tracked(case: Case) -> list[dict]:
    """Errors of the tracking controller at every rate."""
    rates = []
    for rate in RATES:
        controller = deepcopy(led(planned_for(case), rate))
        plan = controller.plan
        rates.append(
            {
                "rate_Hz": rate,
                "reason": controller.reason,
                "planned_N": plan.most_force,
                "passes": bool(controller.events),
                "tracking": followed(changed(controller.model, case), case, controller, plan, rate, plan.tips),
            }
        )
    return rates


def measure(run: Run) -> dict:
    """Rows of the table, and the gains of the PID by delay."""
    gains = {str(delay): run.once(f"gains {delay}", tuned, delay) for delay in (0, LATE)}
    rows = []
    for case in CASES:
        alone = run.once(f"{case.name}: compared", compared, case, tuple(gains[str(case.delay)]))
        pairs = zip(run.once(case.name, tracked, case), alone, strict=True)
        rates = [tracking | others for tracking, others in pairs]
        rows.append({"name": case.name, "pressed": case.distance < np.inf, "most_N": case.force, "rates": rates})
    options = {"force_N": FORCE, "margin_m": MARGIN, "low_force_N": LOW_FORCE, "low_margin_m": LOW_MARGIN}
    frequency = MovingFinger(round_finger(True), [*np.zeros(4), np.inf]).frequencies(np.zeros(4), 1)[0]
    return {"gains": gains, "rows": rows, "frequency_Hz": float(frequency)} | options
