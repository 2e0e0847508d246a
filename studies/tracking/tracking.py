"""Errors of a tip that follows circles and figures of eight, by PIDs of tensions and by the tracking controller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from control import Flaws, Limits, MovingPlant, TrackingController, TrackingOptions, run
from control.loop import Controller
from control.tracking import PidController, circle, eight
from control.tracking.plan import Plan, planned
from rom import GuidedFinger, TouchedSegment
from studies.parts import Run

PERIOD, STEPS = 2e-3, 4  # [s]; of time in a period: twice as many as in the controller's simulation
CENTRE, RADIUS = np.zeros(2), 0.010  # of the paths [m]
RATES, LAPS = (1.0, 2.0, 4.0), 1.5  # [Hz]; the first is not counted
DISTANCE, FORCE = 0.007, 0.1  # of the plane [m]; largest contact force [N]
FRICTION = 0.2  # coefficient of the tendons in their guides [-]
LATE, NOISE = 2, 2e-5  # periods; of the tip's readings [m]
RELAXING = [[0.1, 0.005], [0.1, 0.1]]  # branches of the rubber: moduli over the law's own [-], and times [s]
GAINS = tuple(product((0.0, 0.3, 0.6), (1.0, 4.0, 10.0), (0.0, 0.01, 0.02)))  # proportional, integral, derivative


@dataclass(frozen=True, kw_only=True)
class Case:
    """A path, where the plane is, and how the finger differs from the controller's model.

    Attributes:
        name: for the table.
        shape: of the path.
        distance: of the plane [m].
        delay: of readings, in periods.
        noise: of the tip's readings [m].
        modulus: over the model's [-].
        density: likewise of the rubber [-].
        friction: of the tendons in their guides [-].
        compensated: the same in the controller's options [-].
    """

    name: str
    shape: Callable[..., np.ndarray] = circle
    distance: float = np.inf
    delay: int = 0
    noise: float = 0.0
    modulus: float = 1.0
    density: float = 1.0
    friction: float = 0.0
    compensated: float = 0.0


CASES = (
    Case(name="circle, free"),
    Case(name="circle, free, readings 4 ms late", delay=LATE),
    Case(name="figure of eight, 4 ms late", shape=eight, delay=LATE),
    Case(name="circle, before a plane", distance=DISTANCE),
    Case(name="circle, before a plane, readings 4 ms late", distance=DISTANCE, delay=LATE),
    Case(
        name="circle, before a plane, 10 % stiffer and lighter, noise, 4 ms late",
        distance=DISTANCE,
        delay=LATE,
        noise=NOISE,
        modulus=1.1,
        density=0.9,
    ),
    Case(name="circle, 10 % stiffer and lighter, noise, 4 ms late", delay=LATE, noise=NOISE, modulus=1.1, density=0.9),
    Case(name="circle, 10 % softer and heavier, noise, 4 ms late", delay=LATE, noise=NOISE, modulus=0.9, density=1.1),
    Case(name="circle, friction of 0.2, 4 ms late, not compensated", delay=LATE, friction=FRICTION),
    Case(name="circle, friction of 0.2, 4 ms late, compensated", delay=LATE, friction=FRICTION, compensated=FRICTION),
    Case(
        name="circle, friction of 0.2, 4 ms late, compensated as 0.15", delay=LATE, friction=FRICTION, compensated=0.15
    ),
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


class GuidedPlant(Stopping):
    """A moving finger whose tendons rub in their guides: its tensions are the means that friction at rest leaves."""

    def __init__(self, model: TouchedSegment, friction: float, tensions: np.ndarray, flaws: Flaws):
        self._guides = GuidedFinger(model=model.rod, friction=friction)
        begun = self._guides.advance(tensions).element_tensions.mean(axis=0)
        super().__init__(model, np.inf, flaws=flaws, steps=STEPS, tensions=begun)

    def pull(self, tensions: ArrayLike) -> float:
        """See `control.Plant`."""
        return super().pull(self._guides.advance(tensions).element_tensions.mean(axis=0))


def silicone() -> TouchedSegment:
    """The bundled round finger, whose rubber relaxes."""
    model = TouchedSegment.load("round")
    material = model.scene["material"] | {"prony": RELAXING}
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
    flaws, rest = Flaws(period=PERIOD, delay=case.delay, tip_noise=case.noise), plan.tensions[0]
    if case.friction > 0:
        plant: Stopping = GuidedPlant(model, case.friction, rest, flaws)
    else:
        plant = Stopping(model, case.distance, flaws=flaws, steps=STEPS, tensions=rest)
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
    model, rate, case, options = silicone(), RATES[1], Case(name="", delay=delay), TrackingOptions(period=PERIOD)
    path = circle(CENTRE + model.rod.rest[1:], RADIUS, rate, PERIOD, LAPS)
    plan = planned(model, path, None, options, Limits())

    def error(gains: tuple[float, float, float]) -> float:
        found = followed(model, case, PidController(model, path, gains, options), plan, rate, plan.tips)
        return np.inf if found is None else found["rms_m"]

    return min(GAINS, key=error)


def row(case: Case, gains: tuple[float, float, float]) -> dict:
    """All controllers at every rate."""
    model, rows = silicone(), []
    options = TrackingOptions(period=PERIOD, distance=case.distance, friction=case.compensated, most_force=FORCE)
    finger, free = changed(model, case), replace(options, distance=np.inf)
    for rate in RATES:
        path = case.shape(CENTRE + model.rod.rest[1:], RADIUS, rate, PERIOD, LAPS)
        controller = TrackingController(model, path, options)
        plan, still = controller.plan, planned(model, path, None, free, Limits())
        pids = [PidController(model, path, gains, options, pulled=one) for one in (None, still.tensions)]
        rows.append(
            {
                "rate_Hz": rate,
                "reason": controller.reason,
                "planned_N": float(plan.contact_forces.max()),
                "pid": followed(finger, case, pids[0], still, rate, plan.tips),
                "inverse": followed(finger, case, pids[1], still, rate, plan.tips),
                "tracking": followed(finger, case, controller, plan, rate, plan.tips),
            }
        )
    return {"name": case.name, "pressed": bool(case.distance < np.inf), "rates": rows}


def measure(run: Run) -> dict:
    """Rows of the table, and the gains of the PID by delay."""
    gains = {str(delay): run.once(f"gains {delay}", tuned, delay) for delay in (0, LATE)}
    rows = [run.once(case.name, row, case, tuple(gains[str(case.delay)])) for case in CASES]
    return {"gains": gains, "rows": rows, "radius_m": RADIUS, "period_s": PERIOD, "force_N": FORCE}
