"""What FElupe takes from rest to a tension and along a contact line; imported in FElupe's own process alone.

FElupe's Newton method, full steps, from one load to the next in those of 1, 2, 4 ... equal steps that take the fewest
factorisations, and only these are counted: nobody knows them before, it is the best that a user may hope for.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse.linalg import spsolve

from studies.peers.felupe.finger import Finger, Tolerance
from studies.peers.felupe.steps import FAILURES, Equilibrium, Load, equal_steps

MOST_STEPS = 32  # that are tried
LEAST = 3  # factorisations that every step takes: one that finds nearly all, two that bring it to round-off
# As accurate as the project's own solver (fingerfem.equilibrium.newton.NewtonOptions).
SAME = Tolerance(residual=1e-10, noise=1e-8, settled=1e-10)


def solver(name: str) -> Callable[[Any, np.ndarray], np.ndarray]:
    """SciPy's `spsolve`, FElupe's default, or PyPardiso's, which its documentation recommends."""
    if name == "scipy":
        return spsolve
    if name == "pypardiso":
        import pypardiso  # only there where it is asked for

        return pypardiso.spsolve
    raise ValueError(f"solver must be scipy or pypardiso, got {name}")


def path(finger: Finger, origin: Equilibrium, target: Load, secant: bool) -> tuple[Equilibrium | None, dict[str, Any]]:
    """From one load to another in the equal steps that take least: the answer, None if none lead there; what it took.

    More steps are tried until they take more factorisations, and no longer than that.
    """
    begun_with, reason, steps, made = finger.factorisations, "", 1, 0
    found: Equilibrium | None = None
    best: dict[str, Any] = {"converged": False, "steps": None, "factorisations": None, "seconds": None}
    while steps <= MOST_STEPS and (found is None or LEAST * steps < made):
        before, begun = finger.factorisations, time.process_time()
        finger.limit = np.inf if found is None else before + made
        try:
            found = equal_steps(finger, origin, target, steps, secant)
        except FAILURES as failure:
            if found is not None:
                break
            reason = str(failure).strip()
        else:
            made = finger.factorisations - before
            best = {"converged": True, "steps": steps, "factorisations": made, "seconds": time.process_time() - begun}
        steps *= 2
    finger.limit = np.inf
    best["failed"] = None if found else reason
    return found, best | {"factorisations_with_search": finger.factorisations - begun_with}


def contact_line(finger: Finger, tensions: np.ndarray, distances: list[float], secant: bool) -> dict[str, Any]:
    """The plane comes nearer, state by state, each from the last, the first from where it touches."""
    rest = Equilibrium(finger.rest, Load(0 * tensions, None))
    found, pulled = path(finger, rest, Load(tensions, None), secant)
    if found is not None:
        found = Equilibrium(found.displacement, Load(tensions, finger.reach(found.displacement)))
    rows: list[dict[str, Any]] = []
    for distance in distances:
        if found is None:
            break
        found, row = path(finger, found, Load(tensions, distance), secant)
        force = None if found is None else finger.contact_force(found.displacement, distance)
        rows.append({"distance": distance, "contact_force": force, **row})
    good = [row for row in rows if row["converged"]]
    return {
        "tensions": tensions.tolist(),
        "pulled": pulled,
        "states": rows,
        "converged": len(good) == len(distances),
        "factorisations": sum(row["factorisations"] for row in good),
        "seconds": sum(row["seconds"] for row in good),
        "contact_forces": [row["contact_force"] for row in good],
    }


def measure(arrays: dict[str, np.ndarray], settings: dict[str, Any]) -> tuple[np.ndarray, dict[str, Any]]:
    """From rest to a pull, then from rest along a contact line.

    Seconds are core-seconds without imports, mesh and what is made once.

    Args:
        arrays: of the finger.
        settings: `scene` of the finger; `solver`, scipy or pypardiso; `pull`, tensions [N]; `line`, None or its
            `tensions` [N] and `distances` [m]; `secant`, false if left out: whether every step begins on the secant of
            the last two equilibria, which FElupe leaves to its user.

    Returns:
        the displacement at the end of the pull, shape (1, nodes, 3) [m], zero if it was not reached; what it all took.
    """
    begun = time.process_time()
    finger = Finger(arrays, settings["scene"], SAME, solver(settings["solver"]))
    prepared = time.process_time() - begun
    pull, line, secant = np.array(settings["pull"], float), settings["line"], bool(settings.get("secant", False))
    finger.solve(finger.rest, pull / 1e4, None)  # what is made once: sparsity patterns
    rest = Equilibrium(finger.rest, Load(0 * pull, None))
    found, row = path(finger, rest, Load(pull, None), secant)
    report = {
        "solver": settings["solver"],
        "secant": secant,
        "unknowns": int(finger.rest.size),
        "seconds_to_prepare": prepared,
        "from_rest": row,
        "line": contact_line(finger, np.array(line["tensions"], float), line["distances"], secant) if line else None,
    }
    return np.array([finger.rest if found is None else found.displacement]), report
