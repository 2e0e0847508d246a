"""The ends of the full-order model's ranges: what is accurate, against which reference, and what is refused, and why.

There is no third outcome: a row that is neither ends the study with code 3.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from pydantic import ValidationError

from fingerfem import FingerModel
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.equilibrium.state import State
from fingerfem.scene.laws import STEEL
from fingerfem.scene.scene import Scene
from fingerfem.scene.toml_file import one_line
from studies import sets
from studies.cores import on_cores
from studies.parts import Run

Table = dict[str, Any]
YOUNG = 9.88e6  # of the draft finger's rubber [Pa]
MESH, COARSE = 0.05, 0.15  # errors that a draft mesh may have against a finer one of order 2, and the coarsest [-]
SAME = 1e-6  # relative difference of two ways to one state [-]
FINER = "finer mesh, order 2"
PULL, DISTANCE = [50.0], 0.010  # usual tension [N] and distance of the plane [m]


class Refused(Exception):
    """A refusal with its reason, in place of a result."""


def judged(extreme: str, case: str, reference: str, bound: float, error: Callable[[], float]) -> dict[str, Any]:
    """The verdict on one case of a range: accurate, refused with a reason, or INACCURATE, beyond the bound [-]."""
    row = {"extreme": extreme, "case": case, "bound": bound, "error": None, "reference": reference}
    try:
        found = float(error())
    except (ValueError, LoadNotReached, Refused) as refusal:
        return row | {"outcome": "refused", "reference": str(refusal).splitlines()[0]}
    return row | {"outcome": "accurate" if found <= bound else "INACCURATE", "error": found}


def changed(table: Table, **parts: Any) -> Table:
    """A scene with some entries replaced: geometry=dict(side=...), obstacle=None, ..."""
    table = copy.deepcopy(table)
    for name, value in parts.items():
        table[name] = table[name] | value if isinstance(value, dict) and name != "material" else value
    return {name: value for name, value in table.items() if value is not None}


def planar(**parts: Any) -> Table:
    """The draft scene with the first tendon alone, up to 10 kN; half the finger is modelled."""
    table = sets.draft_table()
    tendon = table["tendons"][0] | {"tension": [0.0, 1e4]}
    return changed(table | {"tendons": [tendon]}, **parts)


def rubber(young: float, poisson: float = 0.3) -> Table:
    """Neo-Hookean rubber of small-strain moduli [Pa], [-]."""
    return {"law": "neo-hookean", "C1": young / (4 * (1 + poisson)), "D1": 6 * (1 - 2 * poisson) / young}


def model(table: Table) -> FingerModel:
    """A model, or the one line that refuses its scene."""
    try:
        return FingerModel(Scene.model_validate(table))
    except ValidationError as error:
        raise Refused(one_line(error)) from None


def solved(finger: FingerModel, tensions: list[float], distance: float | None = None) -> State:
    """A state that is stable and does not intersect itself."""
    state = finger.solve(tensions, distance)
    if state.self_intersecting or not state.stable:
        raise Refused("marked: the finger passes through itself, or its equilibrium is not stable")
    return state


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """Relative distance of two vectors [-]."""
    return float(np.linalg.norm(np.subtract(one, other)) / np.linalg.norm(other))


def same(own: State, true: State, length: float = 1.0, force: float = 1.0) -> float:
    """Error of tip and contact force, the larger, in these units of length and force [-]."""
    error = apart(own.tip / length, true.tip)
    if not own.contact_force or not true.contact_force:
        return error
    return max(error, abs(own.contact_force / force / true.contact_force - 1))


def against_finer(table: Table, tension: float, distance: float | None = None) -> float:
    """Error of tip and contact force, the larger, against a finer mesh of order 2."""
    along, across = table["mesh"]["cells"]
    slender = int(1.2 * max(table["geometry"]["segments"]) / table["geometry"]["side"])  # cells no longer than the side
    fine = {"cells": [max(min(max(along, 16), 30), slender), max(across, 5)], "order": 2}
    own, true = (solved(model(one), [tension], distance) for one in (table, changed(table, mesh=fine)))
    return same(own, true)


def rubbers() -> Iterator[dict]:
    """Poisson's ratio, stiffness, plates against rubber."""
    for poisson in (-0.1, 0.49, 0.4999):
        table = planar(material=rubber(YOUNG, poisson))
        yield judged("Poisson's ratio", f"{poisson:g}", FINER, MESH, partial(against_finer, table, PULL[0], DISTANCE))

    for ratio in (1.0, 1e6):
        young = STEEL.young_modulus / ratio
        error = partial(against_finer, planar(material=rubber(young)), min(50.0 * young / YOUNG, 1e4))
        yield judged("plate over rubber", f"{ratio:g}", FINER, MESH, error)


def sizes() -> Iterator[dict]:
    """Slender, stubby, tiny and huge fingers."""
    for slenderness in (2, 100):
        length, mesh = slenderness * 0.010, {"cells": [max(4 * slenderness, 12), 5]}
        table = planar(obstacle=None, geometry={"segments": [length]}, mesh=mesh)
        # The same turn of the tip, F e L / EI, as a finger of five sides at 50 N.
        error = partial(against_finer, table, 50.0 * 0.05 / length)
        yield judged("length over side", f"{slenderness}", FINER, MESH, error)

    def similar(scale: float) -> float:
        geometry = {"side": 0.010 * scale, "segments": [0.05 * scale], "plate": 0.001 * scale}
        obstacle = {"distance": [0.001 * scale, 0.031 * scale], "pad": None}
        tendon = planar()["tendons"][0] | {"offset": [0.004 * scale, 0.0]}
        large = model(planar(geometry=geometry, obstacle=obstacle, tendons=[tendon]))
        state = solved(large, [50.0 * scale**2], DISTANCE * scale)
        return same(state, solved(model(planar()), PULL, DISTANCE), scale, scale**2)

    for scale in (1e-2, 10.0, 1e2):
        yield judged("side", f"{0.010 * scale:g} m", "the usual finger, scaled", SAME, partial(similar, scale))


def meshes() -> Iterator[dict]:
    """The coarsest meshes, and contact stiffness over six decades."""
    for along, across in ([20, 1], [20, 3], [6, 5], [1, 5]):
        error = partial(against_finer, planar(mesh={"cells": [along, across]}), 20.0)
        yield judged("cells", f"{along} x {across}", FINER, COARSE, error)

    def stiffness(method: str, factor: float) -> float:
        own, true = ({"method": method, "stiffness": factor}, {"method": "nitsche"})
        first, second = (solved(model(planar(obstacle=one)), PULL, DISTANCE) for one in (own, true))
        return same(first, second)

    for method in ("penalty", "nitsche"):
        for factor in (1.0, 1e6):
            name, error = f"{method} parameter", partial(stiffness, method, factor)
            yield judged(name, f"{factor:g}", "Nitsche's method at its default", 0.01, error)


def loads() -> Iterator[dict]:
    """Tensions from next to nothing to where there is no equilibrium, and planes at the reach of the finger."""
    wide = [tendon | {"tension": [0.0, 1e4]} for tendon in sets.draft_table()["tendons"]]
    free = model(changed(sets.draft_table(), obstacle=None, tendons=wide))
    before = model(changed(sets.draft_table(), obstacle={"distance": [1e-9, 0.031]}))
    slope = np.asarray(solved(free, [0.0, 0.0]).sensitivities["tip"]["F1"])  # type: ignore[index]
    reach = solved(before, [50.0, 0.0]).touch_distance or np.nan

    def small(tension: float) -> float:
        return apart(solved(free, [tension, 0.0]).tip, tension * slope)

    def large(tension: float) -> float:
        direct = solved(free, [tension, tension / 4])
        free.continuation.rest()
        free.continuation.advance([0.0, tension / 4], None)
        free.continuation.advance([tension, tension / 4], None)
        return apart(free.problem.tip(), direct.tip)

    def force(d: float) -> float:
        return float(solved(before, [50.0, 0.0], d).contact_force or 0.0)

    for tension in (1e-9, 1e-3):
        # The tip is a difference of positions: round-off of the finger's length is left in it.
        lost = 10 * np.finfo(float).eps * 0.05 / (tension * np.linalg.norm(slope))
        yield judged("tension", f"{tension:g} N", "the linear answer", 0.1 * tension + lost, partial(small, tension))
    for tension in (100.0, 400.0, 1e4):
        case = f"{tension:g} and {tension / 4:g} N"
        yield judged("tension", case, "another path to it", SAME, partial(large, tension))
    yield judged("plane", "d = -1 mm", "no reference", 0.0, partial(force, -0.001))
    for away in (1e-9, 1e-6):
        yield judged("plane", f"{away:g} m out of reach", "no force", 0.0, partial(force, reach + away))
        double = partial(lambda depth: abs(force(reach - 2 * depth) / force(reach - depth) - 2), away)
        yield judged("plane", f"{away:g} m in reach", "force grows linearly", 0.05, double)


PARTS = [loads, rubbers, sizes, meshes]


def tried(part: Callable[[], Iterator[dict]]) -> list[dict]:
    """The rows of one part, printed one by one."""
    rows = []
    for row in part():
        rows.append(row)
        print(f"  {row['outcome']:8s} {row['extreme']}, {row['case']}: {row['error']} {row['reference']}", flush=True)
    return rows


def measure(run: Run) -> list[dict]:
    """All extremes, each part on one core.

    Raises:
        SystemExit: a row is neither accurate nor refused.
    """
    rows = [row for part in on_cores(tried, [(part,) for part in PARTS]) for row in part]
    if any(row["outcome"] == "INACCURATE" for row in rows):
        raise SystemExit(3)
    return rows
