"""The ends of the full-order model's ranges: what is accurate, against which reference, and what is refused, and why.

There is no third outcome: a row that is neither ends the study with code 3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict
from functools import partial

import numpy as np

from fingerfem.scene.laws import STEEL
from studies import sets
from studies.cores import on_cores
from studies.extremes.fingers import INACCURATE, Row, Table, against_finer, apart, changed, force, judged, model, solved
from studies.parts import Run

YOUNG = 9.88e6  # of the draft finger's rubber [Pa]
MESH, COARSE = 0.05, 0.15  # errors that a draft mesh may have against a finer one of order 2, and the coarsest [-]
SAME = 1e-6  # relative difference of two ways to one state [-]


def planar() -> Table:
    """The draft scene with the first tendon alone, so that half the finger is modelled."""
    table = sets.draft_table()
    return changed(table, tendons=table["tendons"][:1])


def rubber(young: float, poisson: float = 0.3) -> Table:
    """Neo-Hookean rubber of small-strain moduli [Pa], [-]."""
    return {"law": "neo-hookean", "C1": young / (4 * (1 + poisson)), "D1": 6 * (1 - 2 * poisson) / young}


def strong(table: Table) -> Table:
    """The same with tensions up to 10 kN."""
    return changed(table, tendons=[tendon | {"tension": [0.0, 1e4]} for tendon in table["tendons"]])


def finer(extreme: str, case: str, table: Table, bound: float, tension: float, d: float | None = None) -> Row:
    """A row of a state under one tension [N], against a finer mesh."""
    return judged(extreme, case, "finer mesh, order 2", bound, lambda: against_finer(table, [tension], d))


def rubbers() -> Iterator[Row]:
    """Poisson's ratio, stiffness, plates against rubber."""
    for poisson in (-0.1, 0.49, 0.4999):
        material = rubber(YOUNG, poisson)
        yield finer("Poisson's ratio", f"{poisson:g}", changed(planar(), material=material), MESH, 50.0, 0.010)

    def scaled(share: float) -> float:
        usual = solved(model(planar()), [50.0], 0.010)
        state = solved(model(strong(changed(planar(), material=rubber(YOUNG * share)))), [50.0 * share], 0.010)
        return max(apart(state.tip, usual.tip), abs(force(state) / share / force(usual) - 1))

    for share in (1e-4, 1e2):
        yield judged("rubber", f"{share:g} times as stiff", "the usual rubber, scaled", MESH, partial(scaled, share))
    yield finer("rubber", "E = 1000 Pa, 100 N", changed(planar(), material=rubber(1e3)), MESH, 100.0)
    for ratio in (1.0, 1e6):
        young = STEEL.young_modulus / ratio
        table = strong(changed(planar(), material=rubber(young)))
        yield finer("plate over rubber", f"{ratio:g}", table, MESH, min(50.0 * young / YOUNG, 1e4))


def sizes() -> Iterator[Row]:
    """Slender, stubby, tiny and huge fingers."""
    for slenderness in (2, 100):
        length = slenderness * 0.010
        mesh = {"cells": [max(4 * slenderness, 12), 5]}
        table = strong(changed(planar(), obstacle=None, geometry={"segments": [length]}, mesh=mesh))
        # The same turn of the tip, F e L / EI, as a finger of five sides at 50 N.
        yield finer("length over side", f"{slenderness}", table, MESH, 50.0 * 0.05 / length)

    def similar(scale: float) -> float:
        usual, table = solved(model(planar()), [50.0], 0.010), planar()
        tendon = table["tendons"][0] | {"offset": [0.004 * scale, 0.0], "tension": [0.0, min(100.0 * scale**2, 1e4)]}
        geometry = {"side": 0.010 * scale, "segments": [0.05 * scale], "plate": 0.001 * scale}
        del table["obstacle"]["pad"]
        obstacle = {"distance": [0.001 * scale, 0.031 * scale]}
        large = model(changed(table, geometry=geometry, tendons=[tendon], obstacle=obstacle))
        state = solved(large, [50.0 * scale**2], 0.010 * scale)
        return max(apart(state.tip / scale, usual.tip), abs(force(state) / scale**2 / force(usual) - 1))

    for scale in (1e-2, 1e2):
        yield judged("side", f"{0.010 * scale:g} m", "the usual finger, scaled", SAME, partial(similar, scale))


def meshes() -> Iterator[Row]:
    """The coarsest meshes and the longest cells."""
    for along, across in ([20, 1], [20, 3], [6, 5], [1, 5]):
        yield finer("cells", f"{along} x {across}", changed(planar(), mesh={"cells": [along, across]}), COARSE, 20.0)


def contact_stiffness() -> Iterator[Row]:
    """Penalty and Nitsche parameters over six decades."""

    def error(method: str, factor: float) -> float:
        usual = force(solved(model(changed(planar(), obstacle={"method": "nitsche"})), [50.0], 0.010))
        table = changed(planar(), obstacle={"method": method, "stiffness": factor})
        return abs(force(solved(model(table), [50.0], 0.010)) / usual - 1)

    for method in ("penalty", "nitsche"):
        for factor in (1.0, 1e6):
            reference = "Nitsche's method at its default"
            yield judged(f"{method} parameter", f"{factor:g}", reference, 0.01, partial(error, method, factor))


def loads() -> Iterator[Row]:
    """Tensions from next to nothing to where there is no equilibrium."""
    wide = strong(changed(sets.draft_table(), obstacle=None))
    finger = model(wide)
    slope = np.asarray(solved(finger, [0.0, 0.0]).sensitivities["tip"]["F1"])  # type: ignore[index]

    def small(tension: float) -> float:
        return apart(solved(finger, [tension, 0.0]).tip, tension * slope)

    for tension in (1e-9, 1e-3):
        # The tip is a difference of positions: round-off of the finger's length is left in it.
        lost = 10 * np.finfo(float).eps * 0.05 / (tension * np.linalg.norm(slope))
        yield judged("tension", f"{tension:g} N", "the linear answer", 0.1 * tension + lost, partial(small, tension))

    def large(tension: float) -> float:
        direct = solved(finger, [tension, tension / 4])
        finger.continuation.rest()
        finger.continuation.advance([0.0, tension / 4], None)
        finger.continuation.advance([tension, tension / 4], None)
        return apart(finger.problem.tip(), direct.tip)

    for tension in (100.0, 400.0, 1e4):
        case = f"{tension:g} and {tension / 4:g} N"
        yield judged("tension", case, "another path to it", SAME, partial(large, tension))
    opposite = [wide["tendons"][0] | {"name": name, "offset": [y, 0.0]} for name, y in (("F1", 0.004), ("F3", -0.004))]
    pair = model(changed(wide, tendons=opposite))

    def straight(tension: float) -> float:
        tip = solved(pair, [tension, tension]).tip
        return float(abs(tip[1] / tip[0]))

    for tension in (100.0, 1e4):
        case = f"{tension:g} N each"
        yield judged("a tendon against its opposite", case, "a straight finger", SAME, partial(straight, tension))


def planes() -> Iterator[Row]:
    """Planes that touch at rest, or where the finger hardly reaches, or cut into it; and detours to one load."""
    finger = model(changed(sets.draft_table(), obstacle={"distance": [1e-9, 0.031]}))
    reach = solved(finger, [50.0, 0.0]).touch_distance
    assert reach is not None

    def felt(d: float, *tensions: float) -> float:
        return force(solved(finger, list(tensions), d))

    def linear(depth: float) -> float:
        return abs(felt(reach - 2 * depth, 50.0, 0.0) / felt(reach - depth, 50.0, 0.0) - 2)

    yield judged("plane", "d = -1 mm", "", 0.0, lambda: felt(-0.001, 50.0, 0.0))
    yield judged("plane", "1e-9 m from rest, no tension", "no force", 0.0, lambda: felt(1e-9, 0.0, 0.0))
    for away in (1e-9, 1e-6):
        yield judged("plane", f"{away:g} m out of reach", "no force", 0.0, partial(felt, reach + away, 50.0, 0.0))
        yield judged("plane", f"{away:g} m in reach", "force grows linearly", 0.05, partial(linear, away))
    direct, random = solved(finger, [60.0, 40.0], 0.006), np.random.default_rng(7)

    def detour() -> float:
        continuation = finger.continuation
        continuation.rest()
        for _ in range(2):
            continuation.advance(random.uniform(0, 100, 2), None)
        continuation.advance(random.uniform([40, 0], [100, 60]), random.uniform(0.004, 0.010))
        continuation.advance([60.0, 40.0], 0.006)
        assert finger.problem.contact is not None
        pressing = finger.problem.contact.force()
        return max(apart(finger.problem.tip(), direct.tip), abs(pressing / force(direct) - 1))

    for k in range(2):
        yield judged("path to a load", f"random, number {k + 1}", "the direct path", SAME, detour)


PARTS = [planes, loads, rubbers, sizes, meshes, contact_stiffness]


def tried(part: Callable[[], Iterator[Row]]) -> list[Row]:
    """The rows of one part, printed one by one."""
    rows = []
    for row in part():
        rows.append(row)
        error = "" if row.error is None else f"{row.error:.1e}"
        print(f"  {row.outcome:8s} {row.extreme}, {row.case}: {error} {row.reference}", flush=True)
    return rows


def measure(run: Run) -> list[dict]:
    """All extremes, each part on one core.

    Raises:
        SystemExit: a row is neither accurate nor refused.
    """
    rows = [row for part in on_cores(tried, [(part,) for part in PARTS]) for row in part]
    inaccurate = sum(row.outcome == INACCURATE for row in rows)
    print(f"  {len(rows)} extremes, {inaccurate} of them neither accurate nor refused")
    if inaccurate:
        raise SystemExit(3)
    return [asdict(row) for row in rows]
