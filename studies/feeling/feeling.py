"""Forces and positions felt without a sensor, from full-order states with noise: errors against noise.

No unbiased estimate scatters less than the bound of Cramer and Rao. With variables x, the derivatives J of what is
measured or expected by x, the standard deviations of these in the diagonal of S, and those of the forces G, it is

    G (J^T S^-2 J)^-1 G^T.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.stats import chi2

from control.feel import Felt, KnownObjects, Noise, UnknownForce
from rom import Rod
from rom.error_statistics import quantiles
from rom.rod.compiled.reports import shortenings_by_force
from studies.feeling.full_order import PLAN, Case, before, error_of, resultant
from studies.parts import Run
from studies.rods import plans

# Standard deviations: shortenings [m], share of the tensions [-]; those of the tensions have 20 mN besides.
LEVELS = (1e-6, 1e-4), (5e-6, 1e-3), (2e-5, 1e-3), (2e-5, 5e-3), (5e-5, 1e-2)
LEAST_TENSION = 0.02  # [N]
DRAWS, SEED = 4, 3  # of noise by state
ASKED_FORCE, ASKED_SHARE, ASKED_POSITION = 0.05, 0.02, 0.002  # [N, -, m]
PLACE = 1e-3  # standard deviation of a position that is known from elsewhere [m]
COVERED, SAMPLES = 0.95, 400  # probability of a region that covers an error; samples of a case's bound


class Trial(NamedTuple):
    """Errors of an estimate's force [N] and position [m], whether its covariance covers the former; its time [us]."""

    force: float
    true_force: float
    position: float
    covered: bool
    unseen: bool
    consistent: bool
    answered: bool
    microseconds: float


class Question(NamedTuple):
    """Estimate from a case's noisy measurements, and the bound of its forces' covariance [N^2]."""

    estimate: Callable[[np.ndarray, np.ndarray, np.random.Generator], Trial]
    bound: np.ndarray | None
    true_force: float


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


def covers(covariance: np.ndarray, error: np.ndarray) -> bool:
    """True if an error lies in the region that covers 95 %; false without a felt contact, which has no covariance."""
    return bool(covariance.any() and error @ np.linalg.solve(covariance, error) <= chi2.ppf(COVERED, len(error)))


def least_covariance(
    case: Case, noise: Noise, by_variables: np.ndarray, forces: np.ndarray, expected: np.ndarray
) -> np.ndarray:
    """The bound of the covariance of k forces, shape (k, k) [N^2].

    Args:
        case: the state; its t tensions are variables, with u unknowns behind.
        noise: of the measurements.
        by_variables: derivatives of the shortenings, shape (t, t + u).
        forces: those of the forces, shape (k, t + u).
        expected: information besides the measurements, shape (u,).
    """
    pulled, shorter = noise.deviations(np.array(case.tensions), 0.0)
    information = np.diag(np.append(pulled**-2.0, expected)) + by_variables.T @ np.diag(shorter**-2.0) @ by_variables
    return forces @ np.linalg.solve(information, forces.T)


def known_object(finger: Rod, case: Case, noise: Noise) -> Question:
    """The object's shape and direction are known; the estimate begins within a millimetre of its distance."""
    model, point, hint = before(finger, case.object), [*case.tensions, case.d], [case.d + 1e-3]
    sensed = KnownObjects(model, noise)
    by_force = model.answers(point).jacobians[0, 3:4]
    bound = least_covariance(case, noise, model.report(point).shortening_jacobian, by_force, np.zeros(1))

    def estimate(pulled: np.ndarray, shorter: np.ndarray, random: np.random.Generator) -> Trial:
        felt, taken = timed(lambda: sensed.feel(pulled, shorter, hint=hint))
        force = felt.contact_forces - case.contact_force
        return Trial(
            abs(float(force[0])),
            case.contact_force,
            abs(float(felt.values[0]) - case.d),
            felt.converged and covers(felt.force_covariance, force),
            bool(len(felt.unseen)),
            felt.consistent,
            felt.converged,
            taken,
        )

    return Question(estimate, bound, case.contact_force)


def one_force(finger: Rod, case: Case, pressed: tuple[float, np.ndarray], noise: Noise, known: bool) -> Question:
    """A force of unknown size and direction across the finger, whose position is known within PLACE, or is not."""
    position, force = pressed
    sensed, size = UnknownForce(finger, noise, most=15.0), float(np.linalg.norm(force))
    front, bound = float(finger.rest[0] + finger.half_lengths[0]), None
    if known:
        _, by_variables, _ = shortenings_by_force(finger.struct, np.array(case.tensions), position, force)
        bound = least_covariance(case, noise, by_variables, np.eye(5)[3:], np.array([PLACE**-2.0, 0.0, 0.0]))

    def estimate(pulled: np.ndarray, shorter: np.ndarray, random: np.random.Generator) -> Trial:
        given = {"position": (float(np.clip(random.normal(position, PLACE), 0.0, front)), PLACE)} if known else {}
        felt, taken = timed(lambda: sensed.feel(pulled, shorter, given))
        return Trial(
            float(np.linalg.norm(felt.values[1:] - force)),
            size,
            abs(float(felt.values[0]) - position),
            felt.converged and covers(felt.covariance[1:, 1:], felt.values[1:] - force),
            bool(len(felt.unseen)),
            felt.consistent,
            felt.converged,
            taken,
        )

    return Question(estimate, bound, size)


def as_asked(errors: np.ndarray, forces: np.ndarray) -> float:
    """The share of forces within what is asked."""
    return float(np.mean(errors <= np.maximum(ASKED_FORCE, ASKED_SHARE * forces)))


def bound_of(asked: list[Question]) -> dict | None:
    """Errors of estimates whose covariances are the bounds."""
    bounds = [one.bound for one in asked if one.bound is not None]
    if not bounds:
        return None
    random = np.random.default_rng(SEED)
    errors = [random.multivariate_normal(np.zeros(len(one)), one, SAMPLES) for one in bounds]
    sizes = np.linalg.norm(np.concatenate(errors), axis=1)
    forces = np.repeat([one.true_force for one in asked], SAMPLES)
    return {"force_N": quantiles(sizes), "within_force": as_asked(sizes, forces)}


def summary(trials: list[Trial]) -> dict:
    """Errors and shares of all trials that have an answer."""
    answered = [one for one in trials if one.answered]
    force, true, position, covered = (np.array([one[k] for one in answered]) for k in range(4))
    return {
        "trials": len(trials),
        "answered": len(answered),
        "force_N": quantiles(force),
        "position_m": quantiles(position),
        "within_force": as_asked(force, true),
        "within_position": float(np.mean(position <= ASKED_POSITION)),
        "covered": float(np.mean(covered)),
        "unseen": float(np.mean([one.unseen for one in answered])),
        "consistent": float(np.mean([one.consistent for one in answered])),
        "us": float(np.median([one.microseconds for one in answered])),
    }


def by_noise(cases: list[Case], prepare: Callable[[int, Noise], Question]) -> list[dict]:
    """A row for every level of noise; a question is prepared for the number of a case."""
    rows = []
    for shortening, share in LEVELS:
        noise, random = Noise(shortening=shortening, tension=LEAST_TENSION, share=share), np.random.default_rng(SEED)
        asked = [prepare(k, noise) for k in range(len(cases))]
        trials = [
            question.estimate(*noisy(case, noise, random), random)
            for case, question in zip(cases, asked, strict=True)
            for _ in range(DRAWS)
        ]
        level = {"shortening_um": 1e6 * shortening, "tension_percent": 100 * share}
        rows.append(level | summary(trials) | {"bound": bound_of(asked)})
    return rows


def measure(run: Run) -> dict:
    """Errors against noise where the object is known, where the position is, and where neither is."""
    finger, sets = plans.rod(run, PLAN), json.loads((run.folder / "states.json").read_text())["result"]
    cases = [Case(**one) for each in sets for one in each["cases"]]
    counts = {name: sum(each[name] for each in sets) for name in ("marked", "force", "failed")}
    return counts | felt(finger, cases)


def felt(finger: Rod, cases: list[Case]) -> dict:
    """Errors of estimates in cases, by noise and by the quantities given."""
    pressed = [resultant(finger, one) for one in cases]
    return {
        "states": len(cases),
        "contact_force_N": quantiles(np.array([one.contact_force for one in cases])),
        "model_error": quantiles(np.array([error_of(finger, one) for one in cases])),
        "known object": by_noise(cases, lambda k, noise: known_object(finger, cases[k], noise)),
        "known position": by_noise(cases, lambda k, noise: one_force(finger, cases[k], pressed[k], noise, True)),
        "unknown position": by_noise(cases, lambda k, noise: one_force(finger, cases[k], pressed[k], noise, False)),
    }
