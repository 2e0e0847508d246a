"""The file of a separated model, docs/format.md: what it holds, and what compiled code and controllers cannot read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from rom.dataset.actuators import count_of
from rom.files.checked_file import read_tree, require, shaped
from rom.native import LIBRARY
from rom.parameter import Parameter
from rom.rod.scene.scene_of_rod import of_tables
from rom.separated.errors import Errors
from rom.separated.form import Separated

if TYPE_CHECKING:
    from rom.separated.model import SeparatedModel

PLAIN = "scene", "accuracy", "provenance"
FREE, CONTACT = ("x", "y", "z", "touch_distance"), ("x", "y", "z", "contact_force", "pad_pressure")
PER_PATH = "tip -, contact force N/m, displacement -, pad pressure Pa/m"  # units of estimated errors
MOST_PARAMETERS = LIBRARY.constants.FINGERFEM_MOST_PARAMETERS
LEAST, MOST_TERMS = 4, 1 << 16  # components of a form; its terms: positions in memory are counted in 32 bits


def contents(model: SeparatedModel) -> dict[str, Any]:
    """The tree of a file, for `rom.files.checked_file.write_tree`."""
    axes = {parameter.name: parameter.unit for parameter in model.parameters[:-1]}
    tree: dict[str, Any] = {name: getattr(model, name) for name in PLAIN} | {
        "lead": model.lead,
        "parameters": [one.as_json() for one in model.parameters],
        "free": _tree(model.free, axes, "m", FREE),
        "contact": _tree(model.contact, axes | {"s": "-"}, "-, -, -, N/m, Pa/m", CONTACT),
        "answered": (model.errors.answered.astype(np.uint8), "-"),
        "error": asdict(model.errors) | {"contact": (model.errors.contact, PER_PATH)},
    }
    if model.nodes is not None:
        fields = {"free": (model.free.field, "m"), "contact": (model.contact.field, "-")}
        tree["displacement"] = {"nodes": (model.nodes, "m")} | fields
    return tree


def read(file: h5py.File) -> dict[str, Any]:
    """The fields of a model by name.

    Raises:
        ModelError: one line that names what is wrong and its limit.
    """
    tree = read_tree(file)
    p, cells = len(tree["parameters"]), tree["answered"]
    require(2 <= p <= MOST_PARAMETERS, f"parameters must be from 2 to {MOST_PARAMETERS}", p)
    cube = cells.size > 0 and cells.shape == (len(cells),) * p
    require(cube, f"cells must be as many along each of {p} parameters", cells.shape)
    parameters = [Parameter(**one) for one in tree["parameters"]]
    texts = [text for one in parameters for text in (one.name, one.unit)]
    require(all(isinstance(text, str) for text in texts), "parameters must have text as names and units", texts)
    _check_ends("parameters", np.array([[one.lower, one.upper] for one in parameters], float).T)
    scene = tree["scene"] | of_tables(tree["scene"] | {"materials": []})  # which may be along a part
    require(count_of(scene) == p - 1, f"tendons and chambers must be {p - 1}", count_of(scene))
    nodes = tree["displacement"]["nodes"] if "displacement" in tree else None
    if nodes is not None:
        shaped("nodes", nodes, (len(nodes), 3))
    free, contact = _form("free", tree, p - 1, FREE), _form("contact", tree, p, CONTACT)
    shaped("error", tree["error"]["contact"], (*cells.shape, len(contact.modes) - 1), finite=False)
    rates = np.where(cells[..., None] != 0, tree["error"]["contact"], np.inf)
    errors = Errors(**tree["error"] | {"contact": rates})
    least = np.min([*errors.alone, errors.touch_distance, errors.margin, rates.min()])
    require(bool(least >= 0 and np.isfinite(errors.margin)), "error must be at least 0", "others")
    own = {"parameters": parameters, "scene": scene, "free": free, "contact": contact, "errors": errors, "nodes": nodes}
    return {name: tree[name] for name in PLAIN} | own


def _tree(form: Separated, axes: dict[str, str], unit: str, names: Sequence[str]) -> dict[str, Any]:
    """A form for its file; of the axes their units by name, of the components their units and names."""
    functions = zip(form.functions, axes.values(), strict=True)
    return {
        "components": list(names[: len(form.modes)]),
        "axes": list(axes),
        "modes": (form.modes, unit),
        "errors": (form.errors, "-"),
        "ends": (form.ends, ", ".join(axes.values())),
    } | {f"functions_{a}": (part, f"-, 1/{of}") for a, (part, of) in enumerate(functions)}


def _form(name: str, tree: dict[str, Any], axes: int, names: Sequence[str]) -> Separated:
    """A form from its file with so many axes; `names` are those of its components, of which some may be missing."""
    own, field = tree[name], tree.get("displacement", {})
    functions, (components, terms) = [own[f"functions_{a}"] for a in range(axes)], own["modes"].shape
    rule = f"{name} must have {LEAST} to {len(names)} components"
    require(LEAST <= components <= len(names), rule, components)
    require(1 <= terms <= MOST_TERMS, f"{name} must have from 1 to {MOST_TERMS} terms", terms)
    arrays = {"ends": own["ends"], "modes": own["modes"], "errors": own["errors"]}
    arrays["field"] = field[name] if field else np.zeros((0, terms))
    size = field["nodes"].size if field else 0
    shapes = {"ends": (2, axes), "modes": (components, terms), "errors": (terms,), "field": (size, terms)}
    for part, shape in shapes.items():
        shaped(f"{part} of {name}", arrays[part], shape)
    for a, function in enumerate(functions):
        shaped(f"functions_{a} of {name}", function, (2, max(*function.shape[1:2], 2), terms))
    _check_ends(f"ends of {name}", own["ends"])
    return Separated(functions=functions, **arrays)


def _check_ends(name: str, ends: np.ndarray) -> None:
    """Refuse lower and upper ends, shape (2, n), that are not finite or do not ascend."""
    ordered = bool(np.isfinite(ends).all() and (ends[0] < ends[1]).all())
    require(ordered, f"{name} must have finite lower ends below their upper ends", ends.tolist())
