"""Verdicts on extremes: accurate against a reference, refused with a reason, or neither."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from fingerfem.equilibrium.failures import LoadNotReached

ROOT = Path(__file__).resolve().parents[2]
ACCURATE, REFUSED, INACCURATE = "accurate", "refused", "INACCURATE"


@dataclass(frozen=True, kw_only=True)
class Row:
    """What became of one extreme.

    Attributes:
        extreme: which range is at its end.
        case: how far.
        outcome: accurate, refused or INACCURATE.
        error: against the reference, relative [-]; None if it was refused.
        bound: that the error must keep [-].
        reference: what the answer is compared with; or the reason of a refusal.
    """

    extreme: str
    case: str
    outcome: str
    error: float | None
    bound: float | None
    reference: str


class Refused(Exception):
    """A result that says why it is none."""


def judged(extreme: str, case: str, reference: str, bound: float, error: Callable[[], float]) -> Row:
    """One row: `error` computes the relative error, or raises what refuses with a reason."""
    try:
        found = float(error())
    except (ValueError, LoadNotReached, Refused) as refusal:
        reason = str(refusal).strip().replace(f"{ROOT}/", "")
        outcome = REFUSED if reason and "\n" not in reason else INACCURATE
        return Row(extreme=extreme, case=case, outcome=outcome, error=None, bound=None, reference=reason)
    outcome = ACCURATE if found <= bound else INACCURATE
    return Row(extreme=extreme, case=case, outcome=outcome, error=found, bound=bound, reference=reference)
