"""A converged answer: what a state of the finger reports, and its sensitivities."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from petsc4py import PETSc

from fingerfem.convergence import NotConverged

if TYPE_CHECKING:
    from fingerfem.model import FingerModel


@dataclass(frozen=True, kw_only=True)
class State:
    """An equilibrium of the full-order model; there is none that has not converged.

    Attributes:
        parameters: tensions [N] and d [m] by name.
        displacement: nodal displacements of this rank, ghosts included, shape (3 nodes,) [m].
        tip: displacement of the tip plate's centre, shape (3,) [m].
        touch_distance: how far the finger reaches towards the plane in free space at these tensions [m].
        contact_force: integral of the contact pressure [N].
        pad_pressure: mean contact pressure over the tip plate's face towards the plane [Pa].
        clamp_reaction: force of the clamp on the finger, shape (3,) [N].
        channel_shortening: by tendon [m].
        energy: total potential [J].
        smallest_volume_ratio: min J [-].
        sensitivities: of tip (m/N; m/m), contact_force (N/N; N/m) and channel_shortening (m/N; m/m), by parameter;
            None if not asked for, or where the tangent is singular and there are none.
        newton_iterations, steps: what it took from rest.
    """

    parameters: dict[str, float]
    displacement: np.ndarray = field(repr=False)
    tip: np.ndarray
    touch_distance: float | None = None
    contact_force: float | None = None
    pad_pressure: float | None = None
    clamp_reaction: np.ndarray
    channel_shortening: dict[str, float]
    energy: float
    smallest_volume_ratio: float
    sensitivities: dict[str, dict[str, Any]] | None = None
    newton_iterations: int
    steps: int
    strategies: dict[str, int]
    seconds: float
    unknowns: int
    converged: bool = True

    def as_json(self) -> dict[str, Any]:
        """Plain numbers, without the field; quantities the scene does not have are left out."""
        listed = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "displacement"}
        return {name: _plain(value) for name, value in listed.items() if value is not None}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return value.tolist() if isinstance(value, np.ndarray) else value


def observe(model: FingerModel, touch_distance: float | None, seconds: float, sensitivities: bool) -> State:
    """Report the equilibrium that `model` is in (collective)."""
    scene, forms, stepper = model.scene, model.forms, model.stepper
    model.residual().destroy()  # the clamp's reaction at this very state
    names = [tendon.name for tendon in scene.tendons]
    rest_lengths = np.array(
        [np.sum(scene.geometry.segments[: t.segment]) - scene.geometry.plate for t in scene.tendons]
    )
    lengths = np.array([model.channel_length(k) for k in range(len(names))])
    energy = model.scalar(forms.strain_energy) + model.scalar(forms.tendon_energy)
    force, pressure = None, None
    if forms.contact is not None:
        energy += model.scalar(forms.contact.energy)
        force = model.scalar(forms.contact.force)
        pressure = model.scalar(forms.contact.pad_force) / (scene.geometry.side * scene.geometry.plate)
    parameters = dict(zip(names, stepper.tensions.tolist(), strict=True))
    if stepper.distance is not None:
        parameters["d"] = float(stepper.distance)
    return State(
        parameters=parameters,
        displacement=model.displacement.copy(),
        tip=model.tip(),
        touch_distance=touch_distance,
        contact_force=force,
        pad_pressure=pressure,
        clamp_reaction=model.clamp_reaction.copy(),
        channel_shortening=dict(zip(names, (rest_lengths - lengths).tolist(), strict=True)),
        energy=energy,
        smallest_volume_ratio=model.smallest_volume_ratio(),
        sensitivities=_sensitivities(model) if sensitivities else None,
        newton_iterations=stepper.iterations,
        steps=stepper.steps,
        strategies=dict(stepper.strategies),
        seconds=seconds,
        unknowns=model.unknowns,
    )


def _sensitivities(model: FingerModel) -> dict[str, dict[str, Any]] | None:
    """Derivatives by every parameter p: du/dp = -K^-1 dR/dp, one back-substitution each on the factorised tangent.

    dR/dF_k is the gradient of channel k's length and dR/dd minus that of the contact force, so the same vectors also
    differentiate those two quantities.
    """
    scene, forms, newton = model.scene, model.forms, model.stepper.newton
    try:
        newton.factorise()
    except NotConverged:
        return None
    count = len(scene.tendons)
    lengths = [_owned(model.load_gradient(unit)) for unit in np.eye(count)]
    tips = [_owned(model.tip_gradient(i)) for i in range(3)]
    loads = {tendon.name: (unit, 0.0) for tendon, unit in zip(scene.tendons, np.eye(count), strict=True)}
    answer: dict[str, dict[str, Any]] = {"tip": {}, "channel_shortening": {}}
    in_contact = forms.contact is not None and model.stepper.distance is not None
    if forms.contact is not None and in_contact:
        loads["d"] = (np.zeros(count), 1.0)
        force = _owned(model.gradient(forms.contact.force_gradient))
        by_distance = {"d": -model.scalar(forms.contact.stiffness)}  # at fixed displacement
        answer["contact_force"] = {}

    for name, (tensions, distance) in loads.items():
        change = -newton.linear_solve(model.load_gradient(tensions, distance))
        answer["tip"][name] = [_along(model, gradient, change) for gradient in tips]
        answer["channel_shortening"][name] = {
            tendon.name: -_along(model, gradient, change)
            for tendon, gradient in zip(scene.tendons, lengths, strict=True)
        }
        if in_contact:
            answer["contact_force"][name] = _along(model, force, change) + by_distance.get(name, 0.0)
    return answer


def _along(model: FingerModel, gradient: np.ndarray, change: np.ndarray) -> float:
    return float(model.comm.allreduce(gradient @ change))


def _owned(b: PETSc.Vec) -> np.ndarray:
    values = b.array_r.copy()
    b.destroy()
    return values
