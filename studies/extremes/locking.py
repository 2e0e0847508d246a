"""Nearly incompressible rubber by mesh and order: errors against a converged mesh, for which none may lock."""

from __future__ import annotations

from typing import Any

from fingerfem.scene.laws import neo_hookean_from
from studies.cores import on_cores
from studies.extremes.extremes import DISTANCE, PULL, YOUNG, apart, model, planar, solved
from studies.parts import Run

POISSON = 0.3, 0.49, 0.4999
MESHES = ([20, 5], 1), ([40, 9], 1), ([10, 5], 2), ([20, 5], 2)  # the draft's first
CONVERGED = [32, 9], 2
STIFFENING = 0.2  # C2 over C1 of Yeoh's rubber [-]


def rubber(law: str, poisson: float) -> dict[str, Any]:
    """The paper's Young's modulus at small strain; Yeoh's rubber stiffens as it is stretched."""
    constants = neo_hookean_from(YOUNG, poisson)
    stiffer = {"C2": STIFFENING * constants.C1} if law == "yeoh" else {}
    return {"law": law, "C1": constants.C1, "D1": constants.D1} | stiffer


def errors(law: str, poisson: float) -> list[dict]:
    """Errors of the tip and of the contact force [-], a row for every mesh."""
    states = []
    for cells, order in (CONVERGED, *MESHES):
        table = planar(material=rubber(law, poisson), mesh={"cells": cells, "order": order})
        states.append(solved(model(table), PULL, DISTANCE))
    true, *others = states
    assert true.contact_force
    rows = []
    for (cells, order), own in zip(MESHES, others, strict=True):
        row = {"law": law, "poisson": poisson, "cells": cells, "order": order, "iterations": own.newton_iterations}
        force = abs((own.contact_force or 0.0) / true.contact_force - 1)
        rows.append(row | {"tip": apart(own.tip, true.tip), "force": force})
    print(f"  {law}, {poisson}: tip {rows[-1]['tip']:.1e}, force {rows[-1]['force']:.1e}", flush=True)
    return rows


def measure(run: Run) -> list[dict]:
    """Two laws at three Poisson's ratios."""
    asked = [(law, poisson) for law in ("neo-hookean", "yeoh") for poisson in POISSON]
    return [row for rows in on_cores(errors, asked) for row in rows]
