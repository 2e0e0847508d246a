"""Contact forces of an assembled finger among random objects, compared with those of the full-order model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rom import AmongObjects, Rod
from rom.error_statistics import quantiles
from studies.cores import on_cores
from studies.rods.full_order import FullOrder, Pressed, Table, rigid

FELT = 0.05  # least contact force that is compared [N]
REASONS = "no answer", "marked", "weak", "rubber", "failed"  # why a draw is not compared
Draw = Callable[[Rod, np.random.Generator], Pressed | None]


@dataclass(frozen=True, kw_only=True)
class Question:
    """Random draws that are compared, `count`; forces up to `most` [N], on "plate", "rubber" or "any" surface."""

    draw: Draw
    seed: tuple[int, ...]
    count: int
    most: float = np.inf
    surface: str = "any"


def answered(finger: Rod, drawn: Pressed, question: Question) -> tuple[str, np.ndarray, np.ndarray, np.ndarray]:
    """Why a draw is not compared, or ""; forces and their estimated errors [N]; wrenches on the plates [N, N m]."""
    model = AmongObjects(rod=finger, obstacles=[rigid(table) for table in drawn.objects])
    point = np.append(drawn.tensions, np.full(len(drawn.objects), drawn.d))
    answer = model.evaluate(point)
    forces, estimates = np.asarray(answer.contact_force), np.asarray(answer.error["contact_force"])
    rubber = any(one.rubber for one in model.contact_forces(point))
    reasons = {
        "no answer": not np.isfinite(estimates).all(),
        "marked": not answer.inside or forces.max() > question.most,
        "weak": forces.min() < FELT or (question.surface == "rubber" and not rubber),
        "rubber": question.surface == "plate" and rubber,
    }
    reason = next((name for name, holds in reasons.items() if holds), "")
    return reason, forces, estimates, model.answers(point).wrenches[0]


def compared(finger: Rod, table: Table, question: Question) -> dict:
    """Errors, estimates and full-order forces of every object [N], and counts of draws that are not compared."""
    full, random = FullOrder(table), np.random.default_rng(question.seed)
    rows: list[tuple[float, float, float]] = []
    counts = dict.fromkeys(("states", *REASONS), 0)
    while counts["states"] < question.count:
        drawn = question.draw(finger, random)
        if drawn is None:
            continue
        reason, forces, estimates, wrenches = answered(finger, drawn, question)
        true = None if reason else full.contact_forces(drawn, wrenches)
        counts[reason or ("states" if true is not None else "failed")] += 1
        if true is not None:
            rows += zip(np.abs(forces - true).tolist(), estimates.tolist(), true.tolist(), strict=True)
    return counts | {"rows": rows}


def summary(parts: list[dict]) -> dict:
    """Counts, quantiles of errors, and the share within the estimates, of one or several parts."""
    errors, estimates, true = np.array([row for part in parts for row in part["rows"]]).T
    return {
        **{name: sum(part[name] for part in parts) for name in ("states", *REASONS)},
        "error": quantiles(errors / true),
        "covered": float((errors <= estimates).mean()),
        "ratio": float(np.median(estimates) / np.median(errors)),
    }


def by_name(finger: Rod, table: Table, questions: dict[str, Question]) -> list[dict]:
    """Summaries of several questions, named, each on one core."""
    found = on_cores(compared, [(finger, table, question) for question in questions.values()])
    return [{"name": name} | summary([one]) for name, one in zip(questions, found, strict=True)]
