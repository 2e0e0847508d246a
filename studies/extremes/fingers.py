"""Extremes of the full-order model: loads, planes, rubber, sizes, meshes, contact parameters, paths."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from fingerfem import FingerModel
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.equilibrium.state import State
from fingerfem.scene.laws import STEEL, neo_hookean_from
from fingerfem.scene.scene import Scene
from fingerfem.scene.toml_file import one_line
from studies.extremes.verdicts import Refused, Row, judged
from studies.solver.solver import contact_force

ROOT = Path(__file__).resolve().parents[2]
PART = "full-order model"
Table = dict[str, Any]
MESH = 0.05  # relative error that a draft mesh may have against a fine one of order 2 [-]
COARSE = 0.15  # the same of the coarsest mesh that is not refused [-]
SAME = 1e-6  # relative difference of two ways to one state [-]


def draft() -> Table:
    """The draft scene as plain data."""
    return tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())


def changed(table: Table, **parts: Any) -> Table:
    """A scene with some entries replaced: geometry=dict(side=...), obstacle=None, ..."""
    table = copy.deepcopy(table)
    for name, value in parts.items():
        if value is None:
            table.pop(name, None)
        elif isinstance(value, dict):
            table[name] = table.get(name, {}) | value
        else:
            table[name] = value
    return table


def planar(table: Table) -> Table:
    """The same with the first tendon alone, so that half the finger is modelled."""
    return changed(table, tendons=table["tendons"][:1])


def model(table: Table) -> FingerModel:
    """A model, or the one line that refuses its scene."""
    try:
        return FingerModel(Scene.model_validate(table))
    except ValidationError as error:
        raise Refused(one_line(error)) from None


def solved(of: FingerModel, tensions: list[float], distance: float | None = None) -> State:
    """A state that says nothing against itself."""
    state = of.solve(tensions, distance)
    if state.self_intersecting:
        raise Refused("marked: the finger passes through itself")
    if not state.stable:
        raise Refused("marked: the equilibrium is not stable")
    return state


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """Relative distance of two vectors [-]."""
    return float(np.linalg.norm(np.subtract(one, other)) / np.linalg.norm(other))


def finer(table: Table) -> Table:
    """The scene on a finer mesh of order 2."""
    along, across = table["mesh"]["cells"]
    geometry = table["geometry"]
    slender = int(1.2 * max(geometry["segments"]) / geometry["side"])  # cells are not longer than the side
    cells = [max(min(max(along, 20), 40), slender), max(across, 5) if across < 8 else 8]
    return changed(table, mesh={"cells": cells, "order": 2})


def against_finer(table: Table, tensions: list[float], distance: float | None = None) -> float:
    """Error of tip and contact force, the larger, against a finer mesh."""
    ours, fine = (solved(model(one), tensions, distance) for one in (table, finer(table)))
    error = apart(ours.tip, fine.tip)
    if distance is None:
        return error
    assert ours.contact_force is not None and fine.contact_force is not None
    return max(error, abs(ours.contact_force / fine.contact_force - 1))


def rows(quick: bool) -> Iterator[Row]:
    """All of them."""
    yield from loads()
    yield from planes()
    yield from rubbers()
    yield from sizes()
    yield from meshes()
    yield from contact_stiffness()
    yield from paths(3 if quick else 12)


def loads() -> Iterator[Row]:
    """Tensions from next to nothing to where there is no equilibrium."""
    free = changed(draft(), obstacle=None)
    wide = changed(free, tendons=[tendon | {"tension": [0.0, 1e4]} for tendon in free["tendons"]])
    finger = model(wide)
    slope = np.asarray(solved(finger, [0.0, 0.0]).sensitivities["tip"]["F1"])  # type: ignore[index]
    for tension in (1e-9, 1e-6, 1e-3):

        def small(tension: float = tension) -> float:
            return apart(solved(finger, [tension, 0.0]).tip, tension * slope)

        # The tip is a difference of places: round-off of the finger's length is left in it.
        lost = 10 * np.finfo(float).eps * 0.05 / (tension * np.linalg.norm(slope))
        yield judged(PART, "tension", f"{tension:g} N", "the linear answer", 0.1 * tension + lost, small)
    for tension in (100.0, 200.0, 400.0, 800.0, 1600.0, 1e4):

        def large(tension: float = tension) -> float:
            direct = solved(finger, [tension, tension / 4])
            finger.continuation.rest()
            finger.continuation.advance([0.0, tension / 4], None)
            finger.continuation.advance([tension, tension / 4], None)
            return apart(finger.problem.tip(), direct.tip)

        yield judged(PART, "tension", f"{tension:g} and {tension / 4:g} N", "another path to it", SAME, large)
    yield judged(
        PART, "tension", "beyond the scene's range", "", 0.0, lambda: float(solved(model(draft()), [101.0, 0.0]).tip[0])
    )
    opposite = [wide["tendons"][0] | {"name": name, "offset": [y, 0.0]} for name, y in (("F1", 0.004), ("F3", -0.004))]
    pair = model(changed(wide, tendons=opposite))
    for tension in (1.0, 100.0, 1e4):

        def straight(tension: float = tension) -> float:
            pair.continuation.rest()
            pair.continuation.advance([tension, 0.0], None)
            pair.continuation.advance([tension, tension], None)
            by_turns, at_once = pair.problem.tip(), solved(pair, [tension, tension]).tip
            return max(abs(at_once[1]), abs(by_turns[1]), abs(by_turns[0] - at_once[0])) / abs(at_once[0])

        what = "straight, and the same by turns"
        yield judged(PART, "a tendon against its opposite", f"{tension:g} N each", what, SAME, straight)


def planes() -> Iterator[Row]:
    """Planes that touch at rest, or where the finger hardly reaches, or cut into it."""
    table = changed(draft(), obstacle={"distance": [1e-9, 0.031]})
    finger = model(table)
    at_rest = model(changed(draft(), obstacle={"distance": [1e-12, 0.031]}))
    reach = solved(finger, [50.0, 0.0]).touch_distance
    assert reach is not None

    def force(distance: float, tensions: list[float]) -> float:
        found = solved(finger, tensions, distance).contact_force
        assert found is not None
        return found

    yield judged(
        PART,
        "plane",
        "d = 0",
        "",
        0.0,
        lambda: model(changed(draft(), obstacle={"distance": [0.0, 0.031]})).problem.energy(),
    )
    yield judged(PART, "plane", "d = -1 mm", "", 0.0, lambda: force(-0.001, [50.0, 0.0]))
    yield judged(PART, "plane", "1e-9 m from rest, no tension", "no force", 0.0, lambda: force(1e-9, [0.0, 0.0]))

    def resting() -> float:
        """The finger lies on the plane and is pulled towards it: what carries is known by the balance alone."""
        state = solved(at_rest, [10.0, 0.0], 1e-12)
        assert state.contact_force
        return abs(state.clamp_reaction[1] - state.contact_force) / state.contact_force

    yield judged(PART, "plane", "touching at rest (1e-12 m), 10 N", "the clamp's reaction", SAME, resting)
    for off in (1e-9, 1e-6):
        yield judged(
            PART, "plane", f"{off:g} m out of reach", "no force", 0.0, partial(force, reach + off, [50.0, 0.0])
        )

        def inside(off: float = off) -> float:
            near, nearer = (force(reach - share * off, [50.0, 0.0]) for share in (1.0, 2.0))
            return abs(nearer / near - 2)

        yield judged(PART, "plane", f"{off:g} m in reach", "force grows with the way", 0.05, inside)


def rubber(poisson: float) -> Table:
    """Neo-Hookean rubber of the usual Young's modulus."""
    return {"law": "neo-hookean", "C1": 9.88e6 / (4 * (1 + poisson)), "D1": 6 * (1 - 2 * poisson) / 9.88e6}


def rubbers() -> Iterator[Row]:
    """Poisson's ratio, stiffness, plates against rubber."""
    one = planar(draft())
    for poisson in (-0.1, 0.0, 0.3, 0.45, 0.49, 0.499, 0.4999):
        table = changed(one, material=rubber(poisson))
        yield judged(
            PART,
            "Poisson's ratio",
            f"{poisson:g}",
            "finer mesh, order 2",
            MESH,
            partial(against_finer, table, [50.0], 0.010),
        )

    def limit() -> float:
        near, nearer = (solved(model(changed(one, material=rubber(p))), [50.0], 0.010) for p in (0.4999, 0.499999))
        assert near.contact_force is not None and nearer.contact_force is not None
        return max(apart(nearer.tip, near.tip), abs(nearer.contact_force / near.contact_force - 1))

    yield judged(PART, "Poisson's ratio", "0.499999", "0.4999 on the same mesh", 1e-4, limit)
    usual = solved(model(one), [50.0], 0.010)
    for young in (1e3, 1e5, 1e7, 1e9):
        share = young / 9.88e6
        law = {"law": "neo-hookean"} | neo_hookean_from(young, 0.3).model_dump(include={"C1", "D1"})
        pulled = [tendon | {"tension": [0.0, 1e4]} for tendon in one["tendons"]]

        def scaled(law: Table = law, share: float = share, pulled: list = pulled) -> float:
            state = solved(model(changed(one, material=law, tendons=pulled)), [50.0 * share], 0.010)
            assert state.contact_force is not None and usual.contact_force is not None
            return max(apart(state.tip, usual.tip), abs(state.contact_force / share / usual.contact_force - 1))

        yield judged(
            PART,
            "rubber",
            f"E = {young:g} Pa, tension alike",
            "the usual rubber, scaled",
            5e-2 if young > 1e8 else 2e-3,
            scaled,
        )
    soft = {"law": "neo-hookean"} | neo_hookean_from(1e3, 0.3).model_dump(include={"C1", "D1"})
    yield judged(
        PART,
        "rubber",
        "E = 1000 Pa, 100 N",
        "finer mesh, order 2",
        MESH,
        lambda: against_finer(changed(one, material=soft), [100.0]),
    )
    for ratio in (1.0, 1e2, 1e4, 1e6):
        young = STEEL.young_modulus / ratio
        law = {"law": "neo-hookean"} | neo_hookean_from(young, 0.3).model_dump(include={"C1", "D1"})
        pulled = [tendon | {"tension": [0.0, 1e4]} for tendon in one["tendons"]]
        tension = min(50.0 * young / 9.88e6, 1e4)
        table = changed(one, material=law, tendons=pulled)
        yield judged(
            PART,
            "plate over rubber",
            f"{ratio:g}",
            "finer mesh, order 2",
            MESH,
            partial(against_finer, table, [tension]),
        )


def sizes() -> Iterator[Row]:
    """Slender, stubby, tiny and huge fingers."""
    one = planar(changed(draft(), obstacle=None))
    for slenderness in (2, 5, 20, 100):
        length = slenderness * 0.010
        cells = [max(4 * slenderness, 12), 5]
        # The same turn of the tip, F e L / EI, as a finger of five sides at 50 N.
        pulled = [tendon | {"tension": [0.0, 1e3]} for tendon in one["tendons"]]
        table = changed(one, geometry={"segments": [length]}, mesh={"cells": cells}, tendons=pulled)
        yield judged(
            PART,
            "length over side",
            f"{slenderness}",
            "finer mesh, order 2",
            MESH,
            partial(against_finer, table, [50.0 * 0.05 / length]),
        )
    usual = solved(model(planar(draft())), [50.0], 0.010)
    for side in (1e-4, 1e-3, 1e-1, 1.0):
        scale = side / 0.010
        table = planar(draft())
        geometry = {"side": side, "segments": [0.05 * scale], "plate": 0.001 * scale}
        tendon = table["tendons"][0] | {"offset": [0.004 * scale, 0.0], "tension": [0.0, min(100.0 * scale**2, 1e4)]}
        table = changed(
            table, geometry=geometry, tendons=[tendon], obstacle={"distance": [0.001 * scale, 0.031 * scale]}
        )
        table["obstacle"].pop("pad", None)

        def similar(table: Table = table, scale: float = scale) -> float:
            state = solved(model(table), [50.0 * scale**2], 0.010 * scale)
            assert state.contact_force is not None and usual.contact_force is not None
            return max(
                apart(state.tip / scale, usual.tip), abs(state.contact_force / scale**2 / usual.contact_force - 1)
            )

        yield judged(PART, "side", f"{side:g} m", "the usual finger, scaled", SAME, similar)


def meshes() -> Iterator[Row]:
    """The coarsest meshes and the flattest cells."""
    one = planar(draft())
    for cells in ([20, 1], [20, 2], [20, 3], [10, 5], [6, 5], [2, 5], [1, 5]):
        table = changed(one, mesh={"cells": cells})
        yield judged(
            PART,
            "cells",
            f"{cells[0]} along, {cells[1]} across",
            "finer mesh, order 2",
            COARSE,
            partial(against_finer, table, [20.0]),
        )
    centred = changed(
        one, geometry={"channel": 0.010}, tendons=[one["tendons"][0] | {"offset": [0.0, 0.0]}], obstacle=None
    )
    yield judged(
        PART,
        "cells",
        "one across, pulled along the axis",
        "finer mesh, order 2",
        MESH,
        lambda: against_finer(changed(centred, mesh={"cells": [20, 1]}), [50.0]),
    )
    for name, cells, bound in (
        ("50 times wider than long", [980, 5], MESH),
        ("20 times longer than wide", [12, 49], COARSE),
        ("50 times longer than wide", [6, 49], COARSE),
    ):
        table = changed(one, mesh={"cells": cells}, obstacle=None)
        yield judged(
            PART,
            "cells",
            name,
            "finer mesh, order 2",
            bound,
            partial(against_finer, table, [20.0]),
        )


def contact_stiffness() -> Iterator[Row]:
    """Penalty and Nitsche parameters over six decades, against the other method at its default."""
    one = planar(draft())
    usual = solved(model(changed(one, obstacle={"method": "nitsche"})), [50.0], 0.010).contact_force
    assert usual is not None
    for method in ("penalty", "nitsche"):
        for factor in (1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6):
            table = changed(one, obstacle={"method": method, "stiffness": factor})

            def off(table: Table = table) -> float:
                found = solved(model(table), [50.0], 0.010).contact_force
                assert found is not None
                return abs(found / usual - 1)

            yield judged(PART, f"{method} parameter", f"{factor:g}", "Nitsche's method at its default", 0.01, off)


def paths(count: int) -> Iterator[Row]:
    """Detours to one load."""
    finger = model(draft())
    direct = solved(finger, [60.0, 40.0], 0.006)
    assert direct.contact_force is not None
    pressed = direct.contact_force
    random = np.random.default_rng(7)
    for k in range(count):

        def detour() -> float:
            continuation = finger.continuation
            continuation.rest()
            for _ in range(3):
                continuation.advance(random.uniform(0, 100, 2), None)
            continuation.advance(random.uniform([40, 0], [100, 60]), random.uniform(0.004, 0.010))
            continuation.advance(random.uniform([40, 0], [100, 60]), random.uniform(0.004, 0.010))
            try:
                continuation.advance([60.0, 40.0], 0.006)
            except LoadNotReached as failure:
                raise Refused(str(failure)) from None
            return max(apart(finger.problem.tip(), direct.tip), abs(contact_force(finger) / pressed - 1))

        yield judged(PART, "path to a load", f"random, number {k + 1}", "the direct path", SAME, detour)
