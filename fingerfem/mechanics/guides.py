"""Coulomb friction of tendons in their guides, as equations for one increment.

A tendon has the tension T_k in layer k, counted from its motor, which has T_0. Between layers k and k + 1 it turns by
theta. There

    T_k <= T_k+1 exp(mu theta) + c    and    T_k+1 <= T_k exp(mu theta) + c,

with friction per length times the distance of the layers' middles, c. It has moved there by the slip s, the sum of the
shortenings of all layers from there to its plate, as it is not extensible. In an increment s stays, or it grows and the
first bound is reached (pulled), or it falls and the second one is (let out). Friction takes (T_k - T_k+1) ds.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

SOFTER = 3.0  # a slip changes a trial tension by its stiffness over this: with less, moves alternate [-]
STICKS, PULLED, LET_OUT, SLACK = range(4)


class Guide(NamedTuple):
    """One tendon in n layers, from the motor to its plate.

    Attributes:
        tensions: shape (n,) [N].
        before: slips at the end of the last increment, where each layer begins, shape (n,) [m].
        shortenings: of the layers, shape (n,) [m].
        turns: between each layer and the one before, or the clamp, shape (n,) [rad].
        motor: the tension there [N].
    """

    tensions: np.ndarray
    before: np.ndarray
    shortenings: np.ndarray
    turns: np.ndarray
    motor: float

    @property
    def slips(self) -> np.ndarray:
        """Slip of the tendon at the start of each layer, shape (n,) [m]."""
        return np.cumsum(self.shortenings[::-1])[::-1]

    @property
    def upstream(self) -> np.ndarray:
        """The tension before each layer, shape (n,) [N]."""
        return np.append(self.motor, self.tensions[:-1])


@dataclass(frozen=True, kw_only=True)
class GuideLaw:
    """Coulomb's law in the guides of a tendon.

    Attributes:
        friction: mu [-].
        per_length: friction besides [N/m].
        distances: between the layers' middles, of the first from the clamp, shape (n,) [m].
    """

    friction: float
    per_length: float
    distances: np.ndarray

    def bounds(self, guide: Guide) -> tuple[np.ndarray, np.ndarray]:
        """exp(mu theta) and c where each layer begins, shapes (n,) [-], [N]."""
        return np.exp(self.friction * guide.turns), self.per_length * self.distances

    def moves(self, guide: Guide, yielding: np.ndarray) -> np.ndarray:
        """State of the tendon at the start of each layer: STICKS, PULLED, LET_OUT or SLACK, shape (n,).

        Args:
            guide: at the present tensions.
            yielding: how far the tendon moves there by its tension beyond, shape (n,) [m/N].
        """
        grows, drag = self.bounds(guide)
        slip = guide.slips - guide.before
        trial = guide.upstream - guide.tensions + slip / (SOFTER * yielding)
        moves = np.full(len(slip), STICKS)
        moves[(guide.tensions <= 0) & (slip > 0)] = SLACK
        moves[trial > guide.tensions * (grows - 1) + drag] = PULLED
        moves[trial < -guide.upstream * (grows - 1) - drag] = LET_OUT
        return moves

    def equations(self, guide: Guide, moves: np.ndarray, sums: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The equations of these moves, of which the turns are taken as they are.

        Args:
            guide: at the present tensions.
            moves: of `moves`.
            sums: derivatives of the slips by all layers' tensions of all tendons, shape (n, all) [m/N].

        Returns:
            residuals, shape (n,) [N, or m where it sticks]; their derivatives by the tendon's own tensions, shape
            (n, n); and the rows that `sums` adds to these, shape (n, all).
        """
        n, (grows, drag) = len(moves), self.bounds(guide)
        own, before = np.eye(n), np.eye(n, k=-1)
        choices = [
            (guide.slips - guide.before, np.zeros((n, n))),
            (guide.upstream - guide.tensions * grows - drag, before - grows[:, None] * own),
            (guide.tensions - guide.upstream * grows - drag, own - grows[:, None] * before),
            (guide.tensions, own),
        ]
        rows = np.arange(n)
        residuals, derivatives = (np.array(one)[moves, rows] for one in zip(*choices, strict=True))
        return residuals, derivatives, np.where((moves == STICKS)[:, None], sums, 0.0)

    def predicted(self, guide: Guide) -> np.ndarray:
        """Tensions moved just into the bounds that those before them set, from the motor on, shape (n,) [N]."""
        grows, drag = self.bounds(guide)
        tensions, last = guide.tensions.copy(), guide.motor
        for k in range(len(tensions)):
            tensions[k] = last = np.clip(tensions[k], max((last - drag[k]) / grows[k], 0.0), last * grows[k] + drag[k])
        return tensions

    def dissipated(self, guide: Guide, last: Guide) -> float:
        """Energy lost by friction in the increment from the last guide [J]; mean force as in rom's `rod/guides.c`."""
        before, now = last.upstream - last.tensions, guide.upstream - guide.tensions
        mean = np.where(before * now > 0, (before + now) / 2, now)
        return float(mean @ (guide.slips - guide.before))
