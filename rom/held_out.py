"""Error of a surrogate against held-out snapshots it was not trained on.

A held-out set has two halves: by one the model's estimated errors are calibrated, on the other they are
tested, with the errors themselves. Nothing that is reported was seen by what it judges.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rom.error_statistics import mean_size, norm, statistics
from rom.file_kinds import uses_of
from rom.rod.objects.shapes import facing_plane
from rom.rod.rod import Rod
from rom.rod.touched_segment import TouchedSegment
from rom.snapshots import mesh_transfer
from rom.snapshots.description import difference
from rom.snapshots.grid import SHARE
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet
from rom.surrogate import Surrogate
from rom.terminal import Progress, quiet

PRESSED = 0.03  # share of the largest pad pressure above which its relative errors are counted
Model = Surrogate | TouchedSegment
FELT = 0.1  # [N] above which relative errors of contact forces are counted
REST = 1e-9  # [m]: of displacements and touch distances, below which no relative error is counted
MARGIN = 5e-5  # [m] from touch, within which a touch decision may be wrong


def split(held_out: SnapshotSet) -> tuple[SnapshotSet, SnapshotSet]:
    """Calibration states and test states of a held-out set: line about, as states of one line are alike."""
    tasks = list(held_out.plan.lines)
    return held_out.only(tasks[::2]), held_out.only(tasks[1::2])


def check(model: Surrogate, held_out: SnapshotSet, progress: Progress = quiet) -> dict[str, Any]:
    """Compare a surrogate with held-out states, and tell `progress` how far that is.

    Of a set by whose first half the model's errors were calibrated, only the other half is taken.

    Relative errors: displacement and tip over the state's own 2-norm, touch distance and contact force over their own
    value; contact force over the states in which the full-order model says more than 0.1 N.

    Its training set, too: then all states are taken, and `training` is true.

    Returns:
        by quantity count, median, p95, max of the relative error, p95_absolute in the quantity's unit and coverage, the
        share of states whose error is at most the estimated one; wrong touch decisions; number of test states and of
        those that calibrated the model; terms; bytes; and, of a scene whose mesh and sampling were chosen by an
        accuracy, a budget or a preset, what was asked, expected and got.

    Raises:
        SnapshotError: the sets do not belong together.
    """
    if held_out.description.fingerprint != model.provenance.get("fingerprint"):
        if "specialised_from" in model.provenance:
            raise SnapshotError(f"{held_out.path}: a table of a finger is compared with that; check the finger itself")
        other = difference(model.scene, held_out.description.scene)
        raise SnapshotError(f"{held_out.path}: must hold states of the scene the model was trained on: {other}")
    calibration = model.provenance.get("calibration", {})
    if calibration.get("set") == held_out.description.held_out_id:
        _, held_out = split(held_out)
    result = _errors(model, held_out, progress, "surrogate") | {"training": not held_out.description.random}
    result["calibration_states"] = calibration.get("states", 0)
    result["terms"], result["bytes"] = model.terms, model.bytes
    expected = model.scene.get("expected")
    if expected:
        result["chosen"] = _chosen(model.scene, expected, result)
    return result


def check_against(model: Surrogate, finer: SnapshotSet, progress: Progress = quiet) -> dict[str, Any]:
    """Compare a surrogate with held-out states of the same finger on another mesh: mesh and surrogate err together.

    Returns:
        what `check` does of errors and touch decisions; cells and order of the set's mesh; and whether the model was
        taught by it what its mesh errs by, in which case there is no coverage.

    Raises:
        SnapshotError: see `check_finer`.
    """
    check_finer(model.scene, finer)
    found = _errors(model, finer, progress, "mesh")
    taught = model.provenance.get("mesh_error", {}).get("set") == finer.description.held_out_id
    if taught or model.errors.mesh is None:
        for one in found.values():
            if isinstance(one, dict):
                one.pop("coverage", None)  # the estimates know nothing of the mesh, or have seen these states
    mesh = finer.description.scene["mesh"]
    return found | {"mesh": {key: mesh[key] for key in ("cells", "order")}, "taught": taught}


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


def check_plane(rod: Rod, held_out: SnapshotSet, progress: Progress = quiet) -> dict[str, Any]:
    """Compare a finger of elements before the plane y = side/2 + d with held-out states of that plane, of any mesh.

    Errors are those of points that the map answers; `marked` counts the others: rubber touches, or the force is beyond
    what was trained.

    Returns:
        what `check` does of errors and touch decisions; `marked`; cells and order of the set's mesh.

    Raises:
        SnapshotError: no held-out set, of another finger, or of none before that plane.
    """
    model, mesh = before_plane(rod, held_out), held_out.description.scene["mesh"]
    found = _errors(model, held_out, progress, "mesh")
    return found | {"mesh": {key: mesh[key] for key in ("cells", "order")}}


def before_plane(rod: Rod, held_out: SnapshotSet) -> TouchedSegment:
    """A finger of elements before the plane of a held-out set.

    Raises:
        SnapshotError: no held-out set, of another finger, or of none before the plane y = side/2 + d.
    """
    _check_plane_of(rod.scene, held_out)
    scene = held_out.description.scene
    plane = facing_plane(scene["geometry"]["side"], tuple(scene["obstacle"]["distance"]))
    return TouchedSegment(rod=rod, obstacle=plane)


def _check_plane_of(own: dict[str, Any], held_out: SnapshotSet) -> None:
    """Refuse what are no held-out states of a finger before the plane."""
    description = held_out.description
    if not description.random or not description.has_obstacle:
        wanted = "must be a held-out set (made with --random) of a scene with a plane"
        raise SnapshotError(f"{held_out.path}: {wanted}{uses_of(held_out.path)}")
    _check_same_finger(own, held_out)


def _check_same_finger(own: dict[str, Any], held_out: SnapshotSet) -> None:
    scene, keys = held_out.description.scene, ("geometry", "material", "tendons")
    other = difference({key: own[key] for key in keys}, {key: scene[key] for key in keys})
    if other:
        raise SnapshotError(f"{held_out.path}: must hold states of the map's finger: {other}")


def differences(model: Model, held_out: SnapshotSet, progress: Progress = quiet) -> dict[str, np.ndarray]:
    """Errors of a model in the states of a set, of any mesh, by quantity in its unit; shapes (states,).

    That of the displacement is the root mean square over the set's nodes.
    """
    points = points_of(held_out)
    answer = model.evaluate(points)
    found = {"tip": norm(answer.tip - held_out.answered("tip"))}
    if isinstance(model, Surrogate) and model.has_field and held_out.description.has_field:
        field, brought = held_out.answered("displacement"), _brought(model.nodes, held_out.nodes)
        found["displacement"] = np.zeros(len(points))
        for k, point in enumerate(points):
            off = brought(model.displacement(point)).reshape(-1, 3) - field[k]
            found["displacement"][k] = mean_size(off)
            progress("checking on held-out states", k + 1, len(points))
    if model.has_obstacle:
        found["touch_distance"] = np.abs(answer.touch_distance - held_out.answered("touch_distance"))
        found["contact_force"] = np.abs(answer.contact_force - held_out.answered("contact_force"))
    if model.has_pad:
        found["pad_pressure"] = np.abs(answer.pad_pressure - held_out.answered("pad_pressure"))
    return found


def _fineness(mesh: dict[str, Any]) -> int:
    """Some number that grows with a mesh's nodes."""
    along, across = (count * mesh["order"] for count in mesh["cells"])
    return int(along * across**2)


def _brought(own: np.ndarray, others: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """What brings a field from a model's nodes to a set's, shape (nodes, 3); none if they are the same."""
    if own.shape == others.shape and np.allclose(own, others, rtol=0, atol=SHARE * np.ptp(own)):
        return lambda field: field
    bring = mesh_transfer.interpolation(own, others)
    return lambda field: bring(field.reshape(-1, 1))


def _errors(model: Model, held_out: SnapshotSet, progress: Progress, of: str) -> dict[str, Any]:
    """Errors of a model in the states of a set that it answers, and wrong touch decisions.

    Those of states on its own mesh are of the surrogate alone, those of others also of the mesh.
    """
    points = points_of(held_out)
    progress("checking on held-out states", 0, len(points))
    answer = model.evaluate(points)
    off = differences(model, held_out, progress)
    estimated = answer.error if of == "mesh" else answer.error_parts["surrogate"]
    true = {name: held_out.answered(name) for name in off}
    sizes = {name: np.abs(value) for name, value in true.items()}
    sizes["tip"] = norm(true["tip"])
    if "displacement" in off:
        sizes["displacement"] = np.array([mean_size(field) for field in true["displacement"]])
    counted = {name: np.array(answer.inside) & (sizes[name] > REST) for name in off}
    if "contact_force" in off:
        counted["contact_force"] &= true["contact_force"] > FELT
    if "pad_pressure" in off:
        counted["pad_pressure"] &= true["pad_pressure"] > PRESSED * true["pad_pressure"].max(initial=0.0)
    result: dict[str, Any] = {"states": len(points), "failed": len(held_out.failures)}
    result["marked"] = int(np.sum(~np.asarray(answer.inside)))
    result |= {
        name: statistics(off[name][own], sizes[name][own], estimated[name][own]) for name, own in counted.items()
    }
    if model.has_obstacle:
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


def points_of(snapshots: SnapshotSet) -> np.ndarray:
    """Parameters of the states that have an answer, shape (states, p); the plane of a free one is infinitely far."""
    points = snapshots.answered("parameters")
    return np.where(np.isnan(points), np.inf, points)


def _chosen(scene: dict[str, Any], expected: dict[str, Any], found: dict[str, Any]) -> dict[str, Any]:
    """What an accuracy, a budget or a preset asked for, what it expected, and what was got.

    The surrogate's error is measured here, against states on its own mesh; the mesh's is that of the front's finger.
    """
    asked = next(f"{key} {scene[key]}" for key in ("accuracy", "budget", "preset") if scene.get(key))
    got = found.get(expected["quantity"], {}).get("p95")
    told = {"asked": asked} | {key: expected[key] for key in ("quantity", "error", "error_of_mesh")}
    of_mesh = expected["error_of_mesh"]
    whole = {} if got is None or of_mesh is None else {"got": got + of_mesh}
    return told | ({} if got is None else {"got_of_surrogate": got}) | whole


def accuracy(report: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The part of a check's report that a model carries along."""
    return {
        name: report[name]
        for name in ("tip", "displacement", "touch_distance", "contact_force", "pad_pressure")
        if name in report
    }


def compared(coarse: SnapshotSet, fine: SnapshotSet) -> dict[str, Any]:
    """What a mesh alone errs by: states of one held-out set against those at the same parameters on a finer mesh.

    Returns:
        by quantity what `check` says of it, without coverage; number of states; cells and order of the finer mesh.
    """
    rows = {point.tobytes(): k for k, point in enumerate(coarse.random("parameters"))}
    shared = [(rows[key], k) for k, point in enumerate(fine.random("parameters")) if (key := point.tobytes()) in rows]
    own, other = np.array(shared, int).reshape(-1, 2).T

    def both(name: str) -> tuple[np.ndarray, np.ndarray]:
        return coarse.random(name)[own], fine.random(name)[other]

    mesh = fine.description.scene["mesh"]
    found: dict[str, Any] = {"states": len(own), "mesh": {key: mesh[key] for key in ("cells", "order")}}
    ours, true = both("tip")
    found["tip"] = statistics(norm(ours - true), norm(true))
    if coarse.description.has_field and fine.description.has_field:
        brought = _brought(coarse.nodes, fine.nodes)
        ours, true = both("displacement")
        true = true.reshape(len(own), -1)
        found["displacement"] = statistics(norm(np.array([brought(one).ravel() for one in ours]) - true), norm(true))
    if coarse.description.has_obstacle:
        for name, least in (("touch_distance", -np.inf), ("contact_force", FELT)):
            ours, true = both(name)
            counted = true > least
            found[name] = statistics(np.abs(ours - true)[counted], np.abs(true)[counted])
    return found
