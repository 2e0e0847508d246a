"""A converged answer: what a state of the finger reports, and its sensitivities."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.continuation import Continuation
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.equilibrium.sensitivities import differentiate
from fingerfem.equilibrium.state_tables import tables
from rom.console.table import Table, as_html


@dataclass(frozen=True, kw_only=True)
class State:
    """An equilibrium of the full-order model; there is none that has not converged.

    Attributes:
        parameters: tensions [N], pressures [Pa], and d [m] or what presses on the plates [N, N m], by name.
        displacement: nodal displacements of this rank, ghosts included, shape (3 nodes,) [m].
        tip: displacement of the tip plate's centre, shape (3,) [m].
        touch_distance: d at which the finger touches the obstacle in free space at these tensions [m]; None if never.
        contact_force: what the obstacle feels along the direction in which d moves it [N]; of a plane that d moves
            along its normal, the integral of the contact pressure.
        contact_forces: of each of several bodies, whose sum is `contact_force`, shape (bodies,) [N]; None of one.
        pad, pad_pressure: name of the scene's tactile pad, and the mean contact pressure on it [Pa].
        penetration: how far the surface's nodes are inside the obstacle at most [m].
        complementarity: integral of contact pressure times |gap| over contact force times side [-]; exactly zero would
            be pressure only where the gap is closed. (Pressure is never negative.)
        clamp_reaction: force of the clamp on the finger, shape (3,) [N]; where a chamber ends at the clamp, without
            the gas that presses on that.
        channel_shortening: by tendon, how much shorter it has become between its ends [m].
        chamber_volumes: by chamber [m^3]; None in a scene without chambers.
        wrenches: on the plates, in their own frames, shape (plates, 6) [N, N m]; None in a scene without a load.
        plate_centres, plate_rotations: of the plates from clamp to tip, shapes (plates, 3) [m], (plates, 3, 3) [-].
        plate_motion: their derivatives by all parameters, see equilibrium.sensitivities.
        energy: total potential [J], of a chamber -p (V - V0), without that of wrenches, which have none.
        smallest_volume_ratio: min J that the law sees [-]: of the mixed form at the points of its pressure.
        stretches: least and largest principal stretch of the rubber [-], if the law names those of its data; of several
            materials, of all whose law does.
        beyond_data: whether a material's exceed its data's, so that its law is a guess; None without such a range.
        guesses: by material whose law is a guess, its least and largest stretch [-]; None where none is.
        self_intersecting: whether the surface passes through itself, which the model does not prevent.
        stable: whether the potential has a minimum here, by the signs of the factorised tangent, against motions of the
            whole finger; None if sensitivities were not asked for.
        sensitivities: of tip (m/N; m/m), contact_force (N/N; N/m), channel_shortening (m/N; m/m) and, where there are
            any, chamber_volumes (m^3/N; m^3/m), by parameter, pressures by Pa;
            None if not asked for, or where the tangent is singular and there are none.
        displacement_sensitivities: of the displacement by parameter, owned nodes, shape (3 nodes,) [m/N; m/m].
        newton_iterations, steps: what it took from rest.
        strategies: steps that each Newton strategy won.
    """

    parameters: dict[str, float]
    displacement: np.ndarray = field(repr=False)
    tip: np.ndarray
    touch_distance: float | None = None
    contact_force: float | None = None
    contact_forces: np.ndarray | None = None
    pad: str | None = None
    pad_pressure: float | None = None
    penetration: float | None = None
    complementarity: float | None = None
    clamp_reaction: np.ndarray
    channel_shortening: dict[str, float]
    chamber_volumes: dict[str, float] | None = None
    wrenches: np.ndarray | None = None
    plate_centres: np.ndarray | None = None
    plate_rotations: np.ndarray | None = None
    plate_motion: np.ndarray | None = None
    energy: float
    smallest_volume_ratio: float
    stretches: list[float] | None = None
    beyond_data: bool | None = None
    guesses: dict[str, list[float]] | None = None
    self_intersecting: bool
    stable: bool | None = None
    sensitivities: dict[str, dict[str, Any]] | None = None
    displacement_sensitivities: dict[str, np.ndarray] | None = field(default=None, repr=False)
    newton_iterations: int
    steps: int
    strategies: dict[str, int]
    seconds: float
    unknowns: int
    converged: bool = True

    def as_json(self) -> dict[str, Any]:
        """Plain numbers, without fields; quantities the scene does not have are left out."""
        fields = ("displacement", "displacement_sensitivities")
        listed = {name: getattr(self, name) for name in self.__dataclass_fields__ if name not in fields}
        return {name: _plain(value) for name, value in listed.items() if value is not None}

    @property
    def marks(self) -> list[str]:
        """Sentences with the reasons not to rely on the state."""
        sentences = ["the finger passes through itself: contact with itself is not modelled"] * self.self_intersecting
        if self.stable is False:
            sentences.append("the equilibrium is not stable: the finger would leave it")
        for name, (low, high) in (self.guesses or {}).items():
            law = "the law" if name == "rubber" else f"the law of {name}"
            sentences.append(f"{law} is a guess at stretches of {low:.3g} to {high:.3g}: see material.stretches")
        return sentences

    def tables(self) -> list[Table | str]:
        """Tables for people."""
        return tables(self.as_json())

    def _repr_html_(self) -> str:
        return as_html(self.tables())


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return value.tolist() if isinstance(value, np.ndarray) else value


def observe(
    continuation: Continuation,
    *,
    touch_distance: float | None,
    self_intersecting: bool,
    seconds: float,
    sensitivities: bool,
) -> State:
    """Report the equilibrium that a continuation has led to (collective)."""
    problem = continuation.problem
    residual, clamp_reaction = problem.residual()
    residual.destroy()
    names = [tendon.name for tendon in problem.scene.tendons]
    actuators = problem.scene.actuators
    parameters = dict(zip(actuators, problem.tensions.tolist(), strict=True))
    if problem.distance is not None:
        parameters["d"] = float(problem.distance)
    if problem.wrenches.any():
        components = problem.scene.parameter_names[len(actuators) :]
        parameters |= dict(zip(components, problem.wrenches.ravel().tolist(), strict=True))
    return State(
        parameters=parameters,
        displacement=problem.displacement.copy(),
        tip=problem.tip(),
        touch_distance=touch_distance,
        **_contact(problem),
        **_plates(problem),
        clamp_reaction=clamp_reaction,
        channel_shortening=dict(zip(names, channel_shortening(problem).tolist(), strict=True)),
        chamber_volumes=dict(zip(actuators[len(names) :], problem.chamber_volumes().tolist(), strict=True)) or None,
        energy=problem.energy(),
        smallest_volume_ratio=problem.smallest_volume_ratio(),
        **stretches(problem),
        self_intersecting=self_intersecting,
        **(_sensitivities(continuation) if sensitivities else {}),
        newton_iterations=continuation.iterations,
        steps=continuation.steps,
        strategies=dict(continuation.strategies),
        seconds=seconds,
        unknowns=problem.unknowns,
    )


def stretches(problem: Problem) -> dict[str, Any]:
    """Range of the rubber's stretches, and whether it exceeds the data of a law; empty without data."""
    extremes_by_material = problem.limits.beyond_data()
    if not extremes_by_material:
        return {}
    lows, highs = zip(*(extremes for extremes, _ in extremes_by_material.values()), strict=True)
    guesses = {name: list(extremes) for name, (extremes, is_beyond) in extremes_by_material.items() if is_beyond}
    return {"stretches": [min(lows), max(highs)], "beyond_data": bool(guesses), "guesses": guesses or None}


def _plates(problem: Problem) -> dict[str, Any]:
    """Wrenches and poses of the plates in a scene with a load; else empty."""
    if problem.plates is None:
        return {}
    poses = problem.plates.poses(problem.displacement)
    return {
        "wrenches": problem.wrenches.copy(),
        "plate_centres": np.array([at.centre for at in poses]),
        "plate_rotations": np.array([at.rotation for at in poses]),
    }


def channel_shortening(problem: Problem) -> np.ndarray:
    """Shortening of every tendon between its ends, shape (tendons,) [m] (collective)."""
    return problem.rest_lengths - [problem.tendon_length(k) for k in range(len(problem.rest_lengths))]


def pad_pressure(problem: Problem) -> float:
    """Mean contact pressure on the pad of a scene that has one [Pa] (collective)."""
    forms = problem.forms.contact[0]
    assert forms.pad_force is not None
    return problem.scalar(forms.pad_force) / problem.scalar(forms.pad_area)


def _contact(problem: Problem) -> dict[str, Any]:
    """Contact force, and the pad's results; empty without an obstacle."""
    contact, obstacle = problem.contact, problem.scene.obstacle
    if contact is None or obstacle is None:
        return {}
    forces = contact.forces()
    force = float(forces.sum())
    results: dict[str, Any] = {"contact_force": force}
    if len(forces) > 1:
        results["contact_forces"] = forces
    if obstacle.pad is not None:
        results |= {"pad": obstacle.pad.name, "pad_pressure": pad_pressure(problem)}
    if problem.distance is not None:
        away = contact.gap_work() / (force * problem.scene.geometry.side) if force else 0.0
        results |= {"penetration": problem.penetration(), "complementarity": away}
    return results


def _sensitivities(continuation: Continuation) -> dict[str, Any]:
    """Derivatives by name, and whether the state is stable."""
    problem = continuation.problem
    try:
        linearisation = continuation.linearise()
    except NotConverged:
        return {"stable": False}
    sensitivities = differentiate(problem, linearisation)
    names = list(problem.scene.parameter_names[: len(sensitivities.tip)])
    tendons = [tendon.name for tendon in problem.scene.tendons]
    answer: dict[str, dict[str, Any]] = {
        "tip": dict(zip(names, sensitivities.tip, strict=True)),
        "channel_shortening": _by_name(names, tendons, sensitivities.channel_shortening),
    }
    if problem.scene.chambers:
        chambers = [chamber.name for chamber in problem.scene.chambers]
        answer["chamber_volumes"] = _by_name(names, chambers, sensitivities.chamber_volumes)
    if sensitivities.contact_force is not None:
        answer["contact_force"] = dict(zip(names, sensitivities.contact_force.tolist(), strict=True))
    return {
        # Stability under following loads depends on the loads, not on the finger alone.
        "stable": None if problem.wrenches.any() else linearisation.stable,
        "plate_motion": sensitivities.plate_motion,
        "sensitivities": answer,
        "displacement_sensitivities": dict(zip(names, sensitivities.displacement, strict=True)),
    }


def _by_name(names: list[str], quantities: list[str], values: np.ndarray) -> dict[str, dict[str, float]]:
    """Derivatives of quantities, shape (parameters, quantities), by the names of both."""
    return {name: dict(zip(quantities, row.tolist(), strict=True)) for name, row in zip(names, values, strict=True)}
