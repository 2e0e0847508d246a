"""The full-order model of one scene: a discrete problem, led to equilibria, which it reports."""

from functools import cached_property
from time import perf_counter

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike

from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.continuation import Continuation
from fingerfem.equilibrium.self_intersection import Surface
from fingerfem.equilibrium.state import State, observe
from fingerfem.equilibrium.strokes.channel_lengths import ChannelLengths
from fingerfem.equilibrium.strokes.section_volumes import SectionVolumes
from fingerfem.scene.loads import check_limits
from fingerfem.scene.scene import Scene


class FingerModel:
    """Solves a scene for loads.

    Args:
        scene: what is modelled.
        comm: the ranks that share one finger; alone by default.

    Example:
        >>> model = FingerModel(load_scene("scenes/draft.toml"))
        >>> model.solve([50.0, 0.0], 0.005).contact_force
    """

    def __init__(self, scene: Scene, comm: MPI.Comm = MPI.COMM_SELF):
        self.scene = scene
        self.problem = Problem(scene, comm)
        self.continuation = Continuation(self.problem)

    def solve(
        self,
        tensions: ArrayLike,
        distance: float | None = None,
        sensitivities: bool = True,
        wrenches: ArrayLike | None = None,
    ) -> State:
        """The equilibrium reached from rest: by tensions; then an obstacle comes from where it touches, or wrenches.

        Args:
            tensions: of every tendon of the scene [N], then pressures of its chambers [Pa], shape (actuators,).
            distance: of the obstacle [m]; None leaves it away.
            sensitivities: also factorise the tangent at the answer and differentiate what the state reports.
            wrenches: on the plates of a scene with a load, from clamp to tip: force and moment about the plate's
                centre in the plate's own frame, shape (plates, 6) [N, N m].

        Raises:
            ValueError: a tension or distance the scene does not allow.
            LoadNotReached: no equilibrium was found; it carries the last good load.
        """
        self.check_loads(tensions, distance)
        if wrenches is not None:
            self._check_wrenches(np.asarray(wrenches, float))
        begun = perf_counter()
        self.continuation.rest()
        self.continuation.advance(tensions, None)
        reach = self.problem.reach() if self.scene.obstacle is not None else -np.inf
        if distance is not None or wrenches is not None:
            self.continuation.advance(tensions, distance, wrenches)
        return observe(
            self.continuation,
            touch_distance=reach if np.isfinite(reach) else None,
            self_intersecting=self.passes_through_itself(),
            seconds=perf_counter() - begun,
            sensitivities=sensitivities,
        )

    def check_loads(self, tensions: ArrayLike, distance: float | None) -> None:
        """Raise ValueError (name, rule, value) for loads the scene does not allow."""
        pulled, actuators = np.asarray(tensions, float), self.scene.actuators
        if pulled.shape != (len(actuators),):
            values_of = f"{len(actuators)} values in N"
            if self.scene.chambers:
                values_of += f", pressures after tensions in Pa ({', '.join(actuators)})"
            raise ValueError(f"tensions must be {values_of}, got shape {pulled.shape}")
        values = dict(zip(actuators, pulled.tolist(), strict=True))
        if distance is not None:
            if self.scene.obstacle is None:
                raise ValueError(f"d must be left out of a scene without an obstacle, got {distance}")
            values["d"] = distance
        check_limits(self.scene, values)

    def _check_wrenches(self, wrenches: np.ndarray) -> None:
        if self.scene.load is None:
            raise ValueError("wrenches must be left out of a scene without a load, got some")
        expected = self.problem.wrenches.shape
        if wrenches.shape != expected or not np.isfinite(wrenches).all():
            raise ValueError(f"wrenches must be finite, shape {expected}, got shape {wrenches.shape}")
        largest = float(np.linalg.norm(wrenches[:, :3], axis=1).max())
        if largest > self.scene.load.force:
            raise ValueError(
                f"wrenches must have forces up to load.force, {self.scene.load.force:g} N, got {largest:g}"
            )

    def take(self, state: State) -> None:
        """Be in a state that was solved before: its displacement and its loads."""
        tensions = [state.parameters[name] for name in self.scene.actuators]
        self.continuation.start(tensions, state.parameters.get("d"), state.displacement, state.wrenches)

    @cached_property
    def channel_lengths(self) -> ChannelLengths:
        """Lengths of the tendons' channels up to every cross-section (collective when it is first asked for)."""
        return ChannelLengths(self.problem)

    @cached_property
    def section_volumes(self) -> SectionVolumes:
        """Volumes of the chambers up to every cross-section (likewise)."""
        return SectionVolumes(self.problem)

    @cached_property
    def _surface(self) -> Surface:
        return Surface(self.problem)

    def passes_through_itself(self) -> bool:
        """True if the finger's surface passes through itself, which nothing in the model prevents (collective)."""
        return self._surface.passes_through_itself(self.problem.displacement.reshape(-1, 3))
