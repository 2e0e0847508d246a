"""A run of a path controller on a plant, and its record."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from control.plant import MovingPlant
from rom.brief import brief


class PathController(Protocol):
    """Interface of controllers for `track`."""

    tensions: np.ndarray
    row: int

    @property
    def done(self) -> bool:
        """Whether the path has ended."""
        ...

    def step(self, tip: np.ndarray, felt: float = 0.0, age: float = 0.0) -> np.ndarray:
        """Return the next tensions, shape (t,) [N]."""
        ...


@brief
@dataclass(frozen=True, kw_only=True)
class Track:
    """Record of a run, from the second row of the path on.

    Attributes:
        tips: true y and z of the tip, shape (n, 2) [m].
        contact_forces: true ones, shape (n,) [N].
        tensions: commanded ones, shape (n, t) [N].
        p50_us, p99_us: median and 99th percentile of the controller's time per period [us].
    """

    tips: np.ndarray = field(repr=False)
    contact_forces: np.ndarray = field(repr=False)
    tensions: np.ndarray = field(repr=False)
    p50_us: float
    p99_us: float

    def errors(self, path: np.ndarray, begin: int = 0) -> np.ndarray:
        """Distances of the tip from a path after row `begin`, shape (m,) [m]."""
        rows = np.asarray(path, float)[1 : 1 + len(self.tips)]
        return np.asarray(np.linalg.norm(self.tips - rows, axis=1)[begin:])


def track(controller: PathController, plant: MovingPlant) -> Track:
    """Run the controller on the plant until the path's end.

    Raises:
        ValueError: the finger leaves the domain of its elements, see `MovingPlant.pull`.
    """
    tips, forces, pulled, spent = list[np.ndarray](), list[float](), list[np.ndarray](), list[float]()
    while not controller.done:
        pulled.append(controller.tensions.copy())
        felt = plant.pull(controller.tensions)
        tips.append(plant.true_tip[1:])
        forces.append(plant.contact_force)
        begun = time.perf_counter()
        controller.step(plant.tip, felt, plant.age)
        spent.append(1e6 * (time.perf_counter() - begun))
    middle, late = np.percentile(spent, [50, 99]) if spent else (0.0, 0.0)
    return Track(
        tips=np.array(tips).reshape(-1, 2),
        contact_forces=np.array(forces),
        tensions=np.array(pulled).reshape(-1, len(controller.tensions)),
        p50_us=float(middle),
        p99_us=float(late),
    )
