"""Models in plain data, as the commands print them by --json."""

from typing import Any

from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.pieces import Piece
from rom.rod.rod import Rod
from rom.separated.model import SeparatedModel


def origin(snapshots: SnapshotSet) -> dict[str, Any]:
    """Origin of a model in plain data: fingerprint, versions, and numbers of states."""
    return {
        "fingerprint": snapshots.description.fingerprint,
        "versions": snapshots.description.versions,
        "states": snapshots.states,
        "failed": len(snapshots.failures),
    }


def rod_summary(finger: Rod) -> dict[str, Any]:
    """A finger of elements in plain data."""
    return {
        "scene": finger.scene["name"],
        "parameters": [one.as_json() for one in finger.parameters],
        "segments": [[_piece(piece) for piece in one] for one in finger.pieces],
        "terms": {kind: len(law.polynomial.powers) for kind, law in finger.elements.laws.items()},
        "contact_force_error": finger.errors.contact_force,
        "place_error_m": finger.errors.position,
        "accuracy": finger.accuracy or "not measured: build with --held-out",
        "calibration": finger.calibration or None,
        "size": finger.similarity.size,
        "modulus": finger.similarity.modulus,
        "trained_on": finger.elements.scene["name"],
        "provenance": finger.elements.provenance,
    }


def _piece(piece: Piece) -> dict[str, Any]:
    """An element in plain data."""
    own = {} if piece.material is None else {"material": piece.material, "modulus_over_rubber": piece.modulus}
    return {"element": piece.kind, "length_m": piece.length} | own


def finer_origin(finer: SnapshotSet) -> dict[str, Any]:
    """The states that the error of a mesh is estimated from, in plain data."""
    mesh = finer.description.scene["mesh"]
    used = {"set": finer.description.held_out_id, "states": finer.states - len(finer.failures)}
    return used | {key: mesh[key] for key in ("cells", "order")}


def separated_summary(model: SeparatedModel) -> dict[str, Any]:
    """A separated model in plain data."""
    return {
        "scene": model.scene["name"],
        "parameters": [one.as_json() for one in model.parameters],
        "terms": model.terms,
        "separation_error": {"free": float(model.free.errors[-1]), "contact": float(model.contact.errors[-1])},
        "accuracy": model.accuracy or "not measured: build with --held-out",
        "nodes": "without the displacement field" if model.nodes is None else len(model.nodes),
        "provenance": model.provenance,
    }
