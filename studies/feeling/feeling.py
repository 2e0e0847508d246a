"""Forces and positions felt without a sensor, from full-order states with noise: errors against noise."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from control.feel import Felt, KnownObjects, Noise, UnknownForce
from rom import Rod
from rom.error_statistics import quantiles
from studies.feeling.full_order import Case, before, error_of, of_shape, resultant
from studies.parts import Run
from studies.rods import plans
from studies.rods.random_objects import SHAPES

# Standard deviations: shortenings [m], share of the tensions [-]; those of the tensions have 20 mN besides.
LEVELS = (1e-6, 1e-4), (5e-6, 1e-3), (2e-5, 1e-3), (2e-5, 5e-3), (5e-5, 1e-2)
LEAST_TENSION = 0.02  # [N]
DRAWS, SEED = 2, 3  # of noise by state
ASKED_FORCE, ASKED_SHARE, ASKED_POSITION = 0.05, 0.02, 0.002  # [N, -, m]
PLACE = 1e-3  # standard deviation of a position that is known from elsewhere [m]


class Trial(NamedTuple):
    """Errors of an estimate of force [N] and position [m], what it says of them, and how long it took [us]."""

    force: float
    true_force: float
    position: float
    force_deviation: float
    unseen: bool
    consistent: bool
    answered: bool
    microseconds: float


Estimate = Callable[[np.ndarray, np.ndarray], Trial]


def noisy(case: Case, noise: Noise, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Tensions [N], not below 0, and shortenings [m] with noise."""
    tensions = np.array(case.tensions)
    off = noise.deviations(tensions, 0.0)
    pulled, shorter = (random.standard_normal(len(tensions)) * one for one in off)
    return np.maximum(tensions + pulled, 0.0), np.array(case.shortenings) + shorter


def timed(call: Callable[[], Felt]) -> tuple[Felt, float]:
    """An estimate, and the time that it took [us]."""
    begun = time.perf_counter()
    felt = call()
    return felt, 1e6 * (time.perf_counter() - begun)


def known_object(finger: Rod, case: Case, noise: Noise) -> Estimate:
    """The object's shape and direction are known; the estimate begins within a millimetre of its distance."""
    sensed, hint = KnownObjects(before(finger, case.object), noise), [case.d + 1e-3]

    def estimate(pulled: np.ndarray, shorter: np.ndarray) -> Trial:
        felt, taken = timed(lambda: sensed.feel(pulled, shorter, hint=hint))
        force = float(felt.contact_forces[0]) - case.contact_force
        return Trial(
            abs(force),
            case.contact_force,
            abs(float(felt.values[0]) - case.d),
            float(felt.force_deviations[0]),
            bool(len(felt.unseen)),
            felt.consistent,
            felt.converged,
            taken,
        )

    return estimate


def one_force(finger: Rod, pressed: tuple[float, np.ndarray], noise: Noise, known: bool) -> Estimate:
    """A force of unknown size and direction across the finger, whose position is known within PLACE, or is not."""
    position, force = pressed
    sensed, size = UnknownForce(finger, noise, most=15.0), float(np.linalg.norm(force))

    def estimate(pulled: np.ndarray, shorter: np.ndarray) -> Trial:
        felt, taken = timed(lambda: sensed.feel(pulled, shorter, {"position": (position, PLACE)} if known else {}))
        found = felt.values[1:]
        along = found / max(float(np.linalg.norm(found)), 1e-9)
        return Trial(
            float(np.linalg.norm(found - force)),
            size,
            abs(float(felt.values[0]) - position),
            float(np.sqrt(along @ felt.covariance[1:, 1:] @ along)),
            bool(len(felt.unseen)),
            felt.consistent,
            felt.converged,
            taken,
        )

    return estimate


def summary(trials: list[Trial]) -> dict:
    """Errors and shares of all trials that have an answer."""
    answered = [one for one in trials if one.answered]
    force, true, position, deviation = (np.array([one[k] for one in answered]) for k in range(4))
    return {
        "trials": len(trials),
        "answered": len(answered),
        "force_N": quantiles(force),
        "position_m": quantiles(position),
        "within_force": float(np.mean(force <= np.maximum(ASKED_FORCE, ASKED_SHARE * true))),
        "within_position": float(np.mean(position <= ASKED_POSITION)),
        "covered": float(np.mean(force <= 1.96 * deviation)),
        "unseen": float(np.mean([one.unseen for one in answered])),
        "consistent": float(np.mean([one.consistent for one in answered])),
        "us": float(np.median([one.microseconds for one in answered])),
    }


def by_noise(cases: list[Case], prepare: Callable[[int, Noise], Estimate]) -> list[dict]:
    """A row for every level of noise; an estimate is prepared for the number of a case."""
    rows = []
    for shortening, share in LEVELS:
        noise, random = Noise(shortening=shortening, tension=LEAST_TENSION, share=share), np.random.default_rng(SEED)
        trials = []
        for k, case in enumerate(cases):
            estimate = prepare(k, noise)
            trials += [estimate(*noisy(case, noise, random)) for _ in range(DRAWS)]
        rows.append({"shortening_um": 1e6 * shortening, "tension_percent": 100 * share, **summary(trials)})
    return rows


def measure(run: Run) -> dict:
    """Errors against noise where the object is known, where the position is, and where neither is."""
    plan = plans.LARGE
    sets = [run.once(shape, of_shape, run, plan, shape) for shape in SHAPES]
    finger = plans.rod(run, plan)
    cases = [Case(**one) for each in sets for one in each["cases"]]
    counts = {name: sum(each[name] for each in sets) for name in ("marked", "force", "failed")}
    return counts | felt(finger, cases)


def felt(finger: Rod, cases: list[Case]) -> dict:
    """What is felt of cases, by noise and by what is known."""
    pressed = [resultant(finger, one) for one in cases]
    return {
        "states": len(cases),
        "contact_force_N": quantiles(np.array([one.contact_force for one in cases])),
        "model_error": quantiles(np.array([error_of(finger, one) for one in cases])),
        "known object": by_noise(cases, lambda k, noise: known_object(finger, cases[k], noise)),
        "known position": by_noise(cases, lambda k, noise: one_force(finger, pressed[k], noise, True)),
        "unknown position": by_noise(cases, lambda k, noise: one_force(finger, pressed[k], noise, False)),
    }
