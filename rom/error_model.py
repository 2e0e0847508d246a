"""The surrogate's estimate of its own error: from leave-one-out residuals, calibrated on held-out states.

The error of a training state is taken as what its fit errs when the state is left out, plus what the separated form
errs at it. Divided by the path past touch it becomes a rate, since what contact adds grows from zero there; a cell
of the regime lookup takes the geometric mean of the rates of the states nearest to it, which tells their order of
magnitude and does not mind one that is extrapolated. Calibration states then scale all rates of a quantity alike, so
that at least 95 % of errors are covered. Without them the rates are taken four times, which is about what they find.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import linprog

from rom.components import Errors
from rom.elements.calibration import conformal as covered
from rom.fit import layout
from rom.fit.contact_response import ContactResponse
from rom.fit.displacement import FittedDisplacement
from rom.fit.free_response import FreeResponse
from rom.fit.mesh_error import COVERAGE, MeshError, covering, place_errors
from rom.held_out import FELT, before_plane, check_finer, differences, points_of, split
from rom.native import answer
from rom.rod.rod import QUANTITIES, Rod
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet
from rom.snapshots.training_states import TrainingStates
from rom.surrogate import Surrogate

CALIBRATED = 98  # percent of calibration states that are scaled to be covered, so that of others COVERAGE are
AROUND = 8  # states whose errors a cell goes by
PLACES = "tip", "touch_distance", "displacement"  # quantities that a mesh errs by in shares of the tip's way
FREE = {"tip", "displacement", "touch_distance"}  # quantities whose errors in free space are known
FEW_STATES, LEAST_FACTOR = 20, 1e-3  # calibration states that scale nothing; factor that none goes below
UNCALIBRATED = 4.0  # factor on the rates as long as no calibration states have scaled them
IDLE = 0.01  # of the middle error of a pad, that it has at least where it bears nothing
ROUND_OFF = 1e-9  # of the largest estimate: below that the difference of two estimates is none [-]
MOSTLY = 0.9  # of states whose mesh's error a first estimate covers, before it is scaled
FEWEST = 3  # states on a finer mesh that touch
LEAST_PLACE = 1e-6  # of the tip's way, that places err by at least where a mesh is judged [-]
MARGIN = 1e-3  # share of the range of d: contact paths below which errors do not become smaller


def estimate(
    model: Surrogate,
    states: TrainingStates,
    free: FreeResponse,
    contact: ContactResponse | None,
    moved: FittedDisplacement | None,
) -> Errors:
    """The errors of a model, from the states it was trained on.

    Args:
        model: the model, whatever its errors.
        states: that it was trained on.
        free: their fit in free space.
        contact: their fits in contact.
        moved: their displacements, fitted.
    """
    separated = model.free_values(free.points)
    errors = np.abs(separated - free.polynomial.value(free.points)) + np.abs(free.fitted.residuals)
    tip = float(np.percentile(np.linalg.norm(errors[:, layout.TIP], axis=1), COVERAGE))
    field = 0.0
    if moved is not None:
        field = _percentile(
            moved.left_out[0] + _field_errors(model, _away(model, free.points), states.free["displacement"])
        )
    if contact is None:
        return Errors(
            tip=tip, displacement=field, touch_distance=0.0, contact=np.zeros((1, 3 + model.has_pad)), margin=1.0
        )
    lower, upper = model.limits
    margin = MARGIN * float(upper[-1] - lower[-1])
    out = answer.answers(model.kernel, contact.parameters)[0]
    found = np.zeros((len(contact.parameters), 3 + model.has_pad))
    truth = states.contact["tip"][contact.kept], contact.force
    found[:, 0] = np.linalg.norm(out[:, layout.TIP] - truth[0], axis=1)
    found[:, 1] = np.abs(out[:, answer.FORCE] - truth[1])
    if model.has_pad:
        pressed = states.contact["pad_pressure"][contact.kept]
        found[:, 3] = np.abs(out[:, answer.PAD] - pressed)
    for part in contact.parts:
        residuals = np.abs(part.outputs.residuals) * part.domain.past[:, None]
        found[part.rows, 0] += np.linalg.norm(residuals[:, layout.TIP], axis=1)
        found[part.rows, 1] += residuals[:, layout.FORCE]
        if model.has_pad:
            found[part.rows, 3] += residuals[:, layout.OUTPUTS.stop]
    if moved is not None:
        field_errors = _field_errors(model, contact.parameters, states.contact["displacement"][contact.kept])
        found[:, 2] = moved.left_out[1] + field_errors
    past = contact.touch_distance - contact.parameters[:, -1]
    rates = UNCALIBRATED * found / (past + margin)[:, None]
    if model.has_pad:  # where the pad bears nothing, nothing seems to be wrong
        some = rates[:, 3][rates[:, 3] > 0]
        rates[:, 3] = np.maximum(rates[:, 3], IDLE * np.median(some) if some.size else 0.0)
    return Errors(
        tip=tip,
        displacement=field,
        touch_distance=_percentile(
            np.take_along_axis(errors[:, layout.HEIGHTS], separated[:, layout.HEIGHTS].argmax(axis=1)[:, None], 1)
        ),
        contact=np.exp(np.log(np.maximum(rates, np.finfo(float).tiny))[contact.around[:, :AROUND]].mean(axis=1)),
        margin=margin,
    )


def calibrated(model: Surrogate, held_out: SnapshotSet) -> Surrogate:
    """The model with its estimated errors scaled so that they hold on the calibration states of a held-out set."""
    held_out, _ = split(held_out)
    found = _scaled(model, held_out, _scale)
    used = {"set": held_out.description.held_out_id, "states": len(points_of(held_out))}
    return replace(found, provenance=model.provenance | {"calibration": used})


def covering_training(model: Surrogate, training: SnapshotSet) -> Surrogate:
    """The model with its estimated errors enlarged, where need be, until they hold on 95 % of its training states.

    Held-out states are seldom at the ends of the box, where errors are largest.
    """
    return _scaled(model, training, _enlarged)


def expected_error(model: Surrogate, training: SnapshotSet) -> float:
    """95th percentile of estimated errors over contact forces above 0.1 N in a model's training states [-]; or 0.

    What its mesh adds is not counted: where little force presses, that is much.
    """
    if not model.has_obstacle:
        return 0.0
    force, errors = training.answered("contact_force"), model.evaluate(points_of(training)).error_parts["surrogate"]
    felt = force > FELT
    return float(np.percentile(errors["contact_force"][felt] / force[felt], COVERAGE)) if felt.any() else 0.0


def _scaled(model: Surrogate, states: SnapshotSet, scale: Callable[[np.ndarray, np.ndarray], float]) -> Surrogate:
    """The model with every estimated error times a factor, which follows from true and estimated ones."""
    points = points_of(states)
    estimated, true = model.evaluate(points).error_parts["surrogate"], differences(model, states)
    touching = states.answered("contact_force") > 0 if model.has_obstacle else np.zeros(len(points), bool)
    errors = model.errors
    # A touch distance is the same whether the plane is touched or not.
    rows = {name: np.ones_like(touching) if name == "touch_distance" else ~touching for name in FREE & true.keys()}
    free = {name: getattr(errors, name) * scale(true[name][own], estimated[name][own]) for name, own in rows.items()}
    contact = errors.contact.copy()
    for column, name in enumerate(("tip", "contact_force", "displacement", "pad_pressure")):
        if name in true:
            before, after = getattr(errors, name, 0.0), free.get(name, 0.0)
            contact[:, column] *= scale(true[name][touching] - after, estimated[name][touching] - before)
    return replace(model, errors=replace(errors, contact=contact, **free))


def with_mesh_error(model: Surrogate, finer: SnapshotSet) -> Surrogate:
    """The model that knows what its mesh errs by, from a held-out set of the same finger on a finer mesh.

    What the surrogate's own estimate leaves of its distance from these states is what the mesh errs by. Shares of it
    (rom.fit.mesh_error) are scaled to the conformal quantile: states drawn like these are covered with 95 % probability
    if there are 19 of them or more, with n / (n + 1) if there are n. Nothing is promised for states that somebody
    chose. Whether it holds, another such set tells (`rom.held_out.check_against`).

    Raises:
        SnapshotError: not a held-out set of the same finger on a finer mesh, or too few states in it that touch.
    """
    check_finer(model.scene, finer)
    points = finer.random("parameters")
    found, estimated = model.evaluate(points), model.evaluate(points).error_parts["surrogate"]
    out = model.outputs(points)
    if model.has_obstacle and (out[:, answer.FORCE] > 0).sum() < FEWEST:
        raise SnapshotError(f"{finer.path}: must have {FEWEST} states that touch, to estimate the error of forces")
    left = {name: np.maximum(off - estimated[name], 0.0) for name, off in differences(model, finer).items()}
    size = np.linalg.norm(found.tip, axis=1)
    shares: dict[str, Any] = dict.fromkeys(PLACES, 0.0)
    shares |= {name: covering(left[name] / size) for name in PLACES if name in left}
    for name, row in (("contact_force", answer.FORCE), ("pad_pressure", answer.PAD)):
        touched = out[:, row] > 0 if name in left else np.zeros(len(points), bool)
        if touched.any():
            by_place = place_errors(model.kernel, points, out, row, size)
            pair = _shares(left[name][touched], out[touched, row], by_place[touched])
            told = MeshError(**shares | {name: pair}).of(model.kernel, points, out)[name]
            some = told > 0  # where only one of the meshes touches among them
            factor = covering(left[name][some] / told[some])
            shares[name] = factor * pair[0], factor * pair[1]
    return replace(
        model,
        errors=replace(model.errors, mesh=MeshError(**shares)),
        provenance=model.provenance | {"mesh_error": origin_of(finer)},
    )


def rod_with_mesh_error(rod: Rod, finer: Sequence[SnapshotSet]) -> Rod:
    """A finger of elements whose estimated errors are enlarged, where need be, to what held-out states show.

    They are of a finer mesh, before the plane y = side/2 + d. The least factor is the conformal quantile, see
    `rom.elements.calibration`: it holds of states drawn like these.

    Raises:
        SnapshotError: not such states of the finger on a finer mesh, or too few that touch.
    """
    ratios: dict[str, list[np.ndarray]] = {name: [] for name in QUANTITIES}
    for one in finer:
        model = before_plane(rod, one)
        check_finer(rod.scene, one)
        answers, off = model.evaluate(one.random("parameters")), differences(model, one)
        touched = answers.inside & (answers.contact_force > 0) & (one.random("contact_force") > 0)
        counted = {name: touched if name == "contact_force" else answers.inside for name in QUANTITIES}
        for name, own in counted.items():
            ratios[name].append(off[name][own] / answers.error[name][own])
    together = {name: np.concatenate(parts) for name, parts in ratios.items()}
    if len(together["contact_force"]) < FEWEST:
        raise SnapshotError(f"{finer[0].path}: must have {FEWEST} states that touch, to estimate the error of forces")
    factors = {name: rod.elements.error_factor(name) * max(covered(found), 1.0) for name, found in together.items()}
    provenance = rod.elements.provenance | {"mesh_error": [origin_of(one) for one in finer]}
    return replace(rod, elements=replace(rod.elements, provenance=provenance, error_factors=factors))


def origin_of(finer: SnapshotSet) -> dict[str, Any]:
    """Which states the error of a mesh is estimated from."""
    mesh = finer.description.scene["mesh"]
    used = {"set": finer.description.held_out_id, "states": finer.states - len(finer.failures)}
    return used | {key: mesh[key] for key in ("cells", "order")}


def _shares(off: np.ndarray, force: np.ndarray, by_place: np.ndarray) -> tuple[float, float]:
    """Shares of the force, and of what a place's error makes, of which most of what is off is the sum.

    By quantile regression, relative to the force; shapes (n,).
    """
    n, weight = len(off), 1 / force
    cost = np.concatenate([[0.0, 0.0], np.full(n, MOSTLY), np.full(n, 1 - MOSTLY)])
    matrix = np.column_stack([force * weight, by_place * weight, np.eye(n), -np.eye(n)])
    found = linprog(cost, A_eq=matrix, b_eq=off * weight)
    return float(found.x[0]), float(max(found.x[1], LEAST_PLACE))


def _scale(true: np.ndarray, estimated: np.ndarray) -> float:
    """Factor on estimated errors, shape (states,), that covers enough of the true ones; 1 if there are too few."""
    ratios = _ratios(true, estimated)
    return max(float(np.percentile(ratios, CALIBRATED)), LEAST_FACTOR) if len(ratios) >= FEW_STATES else 1.0


def _enlarged(true: np.ndarray, estimated: np.ndarray) -> float:
    """Factor of at least 1 on estimated errors, shape (states,), that covers COVERAGE percent of the true ones."""
    ratios = _ratios(true, estimated)
    return max(float(np.percentile(ratios, COVERAGE)), 1.0) if ratios.size else 1.0


def _ratios(true: np.ndarray, estimated: np.ndarray) -> np.ndarray:
    """True errors over estimated ones; without states where nothing is estimated, as the model does not touch there."""
    some = estimated > ROUND_OFF * estimated.max(initial=0.0)
    return np.asarray(true[some] / estimated[some])


def _percentile(errors: np.ndarray) -> float:
    return float(np.percentile(errors, COVERAGE))


def _away(model: Surrogate, tensions: np.ndarray) -> np.ndarray:
    """Parameters of free states at tensions, shape (n, tensions): the plane is far away."""
    return np.column_stack([tensions, np.full(len(tensions), np.inf)]) if model.has_obstacle else tensions


def _field_errors(model: Surrogate, parameters: np.ndarray, field: np.ndarray) -> np.ndarray:
    """Errors of the displacement at states, root mean square over the nodes, shape (n,) [m].

    Args:
        model: with the field.
        parameters: shape (n, p).
        field: the displacements there, shape (n, nodes, 3) [m].
    """
    found = [model.displacement(point) - true for point, true in zip(parameters, field, strict=True)]
    return np.array([np.sqrt(np.mean(np.sum(one**2, axis=1))) for one in found])
