"""Errors of a finger, or of a separated model, in held-out states before the plane y = side/2 + d, of any mesh."""

from collections.abc import Callable
from typing import Any

import numpy as np

from rom import error_statistics as statistics
from rom.console.terminal import Progress, quiet
from rom.dataset import mesh_transfer
from rom.dataset.description import difference
from rom.dataset.grid import SHARE
from rom.dataset.sections.section import top
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet
from rom.error_statistics import mean_size
from rom.files.file_kinds import uses_of
from rom.rod.objects.shapes import facing_plane
from rom.rod.rod import Rod
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel

Model = SeparatedModel | TouchedSegment
MARGIN = 5e-5  # [m] from touch, within which a touch decision may be wrong


def check(model: Rod | SeparatedModel, held_out: SnapshotSet, progress: Progress = quiet) -> dict[str, Any]:
    """Compare a model with states before the plane y = side/2 + d, held-out ones or those that it was trained on.

    Displacement and tip have errors relative to the state's own 2-norm, touch distance and contact force to their own
    value; contact forces count where the full-order model has more than 0.1 N. Errors are those of states inside the
    model's domain; `marked` counts the others.

    Returns:
        by quantity count, median, p95, max of the relative error, p95_absolute in the quantity's unit and coverage, the
        share of states whose error is at most the estimated one; touch decisions; numbers of states; whether these are
        training states; cells and order of the set's mesh.

    Raises:
        SnapshotError: a set of another finger, or without the plane.
    """
    if isinstance(model, Rod):
        before: Model = before_plane(model, held_out)
    else:
        before = model
        if not model.provenance.get("facing_plane", True):
            raise SnapshotError(
                f"{held_out.path}: must hold states before the model's object, which is no facing plane"
            )
        _check_plane_of(model.scene, held_out)
    mesh = held_out.description.scene["mesh"]
    return _errors(before, held_out, progress) | {
        "training": not held_out.description.random,
        "mesh": {key: mesh[key] for key in ("cells", "order")},
    }


def check_finer(scene: dict[str, Any], finer: SnapshotSet) -> None:
    """Refuse what is no held-out set of a model's finger on a finer mesh than its scene's.

    Raises:
        SnapshotError: a training set, one of another finger, or of a mesh that is not finer; or, for a scene with a
            load, neither of a load nor before the plane y = side/2 + d.
    """
    if not finer.description.random:
        raise SnapshotError(f"{finer.path}: must be a held-out set (made with --random){uses_of(finer.path)}")
    if scene.get("load") is not None and finer.description.has_load:
        _check_same_finger(scene, finer)
    elif scene.get("load") is not None:
        _check_plane_of(scene, finer)
    else:
        mesh_transfer.check_finger(finer, scene, "the model")
    mesh, own = finer.description.scene["mesh"], scene["mesh"]
    if _fineness(mesh) <= _fineness(own):
        cells, order = " x ".join(map(str, own["cells"])), own["order"]
        raise SnapshotError(f"{finer.path}: must be of a finer mesh than the model's {cells} cells of order {order}")


def before_plane(rod: Rod, held_out: SnapshotSet) -> TouchedSegment:
    """A finger of elements before the plane of a held-out set.

    Raises:
        SnapshotError: no held-out set, of another finger, or of none before the plane y = side/2 + d.
    """
    _check_plane_of(rod.scene, held_out)
    scene = held_out.description.scene
    plane = facing_plane(2 * top(scene), tuple(scene["obstacle"]["distance"]))
    return TouchedSegment(rod=rod, obstacle=plane)


def _check_plane_of(own: dict[str, Any], held_out: SnapshotSet) -> None:
    """Refuse states that are not of a finger before the plane."""
    if not held_out.description.has_obstacle:
        raise SnapshotError(f"{held_out.path}: must be of a scene with a plane{uses_of(held_out.path)}")
    _check_same_finger(own, held_out)


def _check_same_finger(own: dict[str, Any], held_out: SnapshotSet) -> None:
    scene, keys = held_out.description.scene, ("geometry", "section", "material", "materials", "tendons", "gravity")
    other = difference({key: own.get(key) for key in keys}, {key: scene.get(key) for key in keys})
    if other:
        raise SnapshotError(f"{held_out.path}: must hold states of the model's finger: {other}")


def differences(model: Model, held_out: SnapshotSet, progress: Progress = quiet) -> dict[str, np.ndarray]:
    """Errors of a model in the states of a set, of any mesh, by quantity in its unit; shapes (states,).

    That of the displacement is the root mean square over the set's nodes.
    """
    points = held_out.points()
    errors = statistics.differences(
        model.evaluate(points), {name: held_out.answered(name) for name in _shared(model, held_out)}
    )
    if isinstance(model, SeparatedModel) and model.nodes is not None and held_out.description.has_field:
        field, brought = held_out.answered("displacement"), _brought(model.nodes, held_out.nodes)
        errors["displacement"] = np.zeros(len(points))
        for k, point in enumerate(points):
            off = brought(model.displacement(point)).reshape(-1, 3) - field[k]
            errors["displacement"][k] = mean_size(off)
            progress("checking on held-out states", k + 1, len(points))
    return errors


def _shared(model: Model, held_out: SnapshotSet) -> list[str]:
    """Quantities that both have, without the displacement."""
    pad = model.has_pad and "pad_pressure" in held_out.description.stored
    return ["tip", "touch_distance", "contact_force", *["pad_pressure"] * pad]


def _fineness(mesh: dict[str, Any]) -> int:
    """Some number that grows with a mesh's nodes."""
    along, across = (count * mesh["order"] for count in mesh["cells"])
    return int(along * across**2)


def _brought(own: np.ndarray, others: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Interpolation of a field, shape (nodes, 3), from a model's nodes to a set's; the identity if they agree."""
    if own.shape == others.shape and np.allclose(own, others, rtol=0, atol=SHARE * np.ptp(own)):
        return lambda field: field
    bring = mesh_transfer.interpolation(own, others)
    return lambda field: bring(field.reshape(-1, 1))


def _errors(model: Model, held_out: SnapshotSet, progress: Progress) -> dict[str, Any]:
    """Errors of a model in the states of a set inside its domain, and wrong touch decisions."""
    points = held_out.points()
    progress("checking on held-out states", 0, len(points))
    answer = model.evaluate(points)
    off = differences(model, held_out, progress)
    true = {name: held_out.answered(name) for name in off}
    result: dict[str, Any] = {"states": len(points), "failed": len(held_out.failures)}
    result["marked"] = int(np.sum(~np.asarray(answer.inside)))
    result |= statistics.compared(answer, true, off, np.asarray(answer.inside))
    touches, felt = true["contact_force"] > 0, answer.contact_force > 0
    wrong = (answer.touch_distance > points[:, -1]) != touches
    close = np.abs(true["touch_distance"] - points[:, -1]) <= MARGIN
    result["touch"] = {
        "count": len(points),
        "touching": int(touches.sum()),
        "wrong": int(wrong.sum()),
        "wrong_beyond_margin": int((wrong & ~close).sum()),
        "margin": MARGIN,
        "right": float(1 - wrong.mean()),
        "force_without_touch": int((felt & ~touches).sum()),
    }
    progress("checking on held-out states", len(points), len(points))
    return result


def accuracy(report: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The part of a check's report that a model's file keeps."""
    return {
        name: report[name]
        for name in ("tip", "displacement", "touch_distance", "contact_force", "pad_pressure")
        if name in report
    }
