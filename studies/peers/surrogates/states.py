"""The states that other surrogates are trained on and tested with; any Python can read them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

LINES, QUICK_LINES = (10, 20, 40), (10, 20)  # of the training set: learning curves


@dataclass(frozen=True, kw_only=True)
class States:
    """Solved states of a finger before a plane, without their sensitivities.

    Attributes:
        tensions: of the free states, shape (free, tensions) [N].
        free_tip: shape (free, 3) [m].
        touch_distance: of the plane that the same just touch, shape (free,) [m].
        parameters: tensions and d of the states in contact, shape (contact, p) [N, m].
        reach: their touch distances, shape (contact,) [m].
        tip: shape (contact, 3) [m].
        force: contact forces, shape (contact,) [N].
        lower: ends of the parameters, shape (p,) [N, m].
        upper: shape (p,) [N, m].
    """

    tensions: np.ndarray
    free_tip: np.ndarray
    touch_distance: np.ndarray
    parameters: np.ndarray
    reach: np.ndarray
    tip: np.ndarray
    force: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    def save(self, file: Path) -> None:
        """Write them (npz)."""
        np.savez(file, **asdict(self))

    @classmethod
    def load(cls, file: Path) -> States:
        """Read what `save` has written."""
        with np.load(file) as stored:
            return cls(**stored)

    @property
    def count(self) -> int:
        """Free and contact states."""
        return len(self.tensions) + len(self.parameters)

    @property
    def pressed(self) -> np.ndarray:
        """Tip and contact force of the states in contact, shape (contact, 4)."""
        return np.column_stack([self.tip, self.force])

    def scaled(self, places: np.ndarray) -> np.ndarray:
        """Tensions, or tensions and d, in shares of their ranges [-]."""
        count = places.shape[-1]
        return (places - self.lower[:count]) / (self.upper[:count] - self.lower[:count])


@dataclass(frozen=True, kw_only=True)
class HeldOut:
    """Held-out states.

    Attributes:
        parameters: tensions and d, shape (states, p) [N, m].
        tip: shape (states, 3) [m].
        force: shape (states,) [N].
    """

    parameters: np.ndarray
    tip: np.ndarray
    force: np.ndarray

    def save(self, file: Path) -> None:
        """Write them (npz)."""
        np.savez(file, **asdict(self))

    @classmethod
    def load(cls, file: Path) -> HeldOut:
        """Read what `save` has written."""
        with np.load(file) as stored:
            return cls(**stored)
