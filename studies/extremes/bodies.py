"""Extremes of what a finger is: rubber, sizes, meshes, contact parameters."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from fingerfem.scene.laws import STEEL, neo_hookean_from
from studies.extremes.fingers import (
    COARSE,
    MESH,
    PART,
    SAME,
    Table,
    against_finer,
    apart,
    changed,
    draft,
    model,
    planar,
    solved,
)
from studies.extremes.verdicts import Row, judged


def rows() -> Iterator[Row]:
    """All of them."""
    yield from rubbers()
    yield from sizes()
    yield from meshes()
    yield from contact_stiffness()


def rubber(poisson: float) -> Table:
    """Neo-Hookean rubber of the usual Young's modulus."""
    return {"law": "neo-hookean", "C1": 9.88e6 / (4 * (1 + poisson)), "D1": 6 * (1 - 2 * poisson) / 9.88e6}


def rubbers() -> Iterator[Row]:
    """Poisson's ratio, stiffness, plates against rubber."""
    one = planar(draft())
    for poisson in (-0.1, 0.3, 0.49, 0.4999):
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
    for young in (1e3, 1e9):
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
    for ratio in (1.0, 1e3, 1e6):
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
    for slenderness in (2, 20, 100):
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
    for side in (1e-4, 1.0):
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
        for factor in (1.0, 1e2, 1e4, 1e6):
            table = changed(one, obstacle={"method": method, "stiffness": factor})

            def off(table: Table = table) -> float:
                found = solved(model(table), [50.0], 0.010).contact_force
                assert found is not None
                return abs(found / usual - 1)

            yield judged(PART, f"{method} parameter", f"{factor:g}", "Nitsche's method at its default", 0.01, off)
