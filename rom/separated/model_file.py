"""The file of a separated model, docs/format.md: what it holds, and what compiled code and controllers cannot read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from rom.checked_file import require, shaped
from rom.native import LIBRARY
from rom.parameter import Parameter
from rom.rod.scene_of_rod import of_tables
from rom.separated.form import Separated

if TYPE_CHECKING:
    from rom.separated.model import SeparatedModel

PLAIN = ("parameters", "scene", "accuracy", "provenance", "lead")
FREE, CONTACT = ("x", "y", "z", "touch_distance"), ("x", "y", "z", "contact_force", "pad_pressure")
PER_PATH = "tip -, contact force N/m, displacement -, pad pressure Pa/m"  # units of estimated errors
MOST_PARAMETERS = LIBRARY.constants.FINGERFEM_MOST_PARAMETERS
MOST_TERMS = 1 << 16  # positions in memory are counted in 32 bits


def contents(model: SeparatedModel) -> dict[str, Any]:
    """The tree of a file, for `rom.checked_file.write_tree`."""
    axes = [(parameter.name, parameter.unit) for parameter in model.parameters[:-1]]
    cells = (model.cells,) * len(model.parameters)
    tree: dict[str, Any] = {name: getattr(model, name) for name in PLAIN} | {
        "parameters": [one.as_json() for one in model.parameters],
        "free": _tree(model.free, axes, "m", FREE),
        "contact": _tree(model.contact, [*axes, ("s", "-")], "-, -, -, N/m, Pa/m", CONTACT),
        "answered": (model.answered.astype(np.uint8).reshape(cells), "-"),
        "error": asdict(model.errors) | {"contact": (model.errors.contact.reshape(*cells, -1), PER_PATH)},
    }
    if model.displacements is not None:
        nodes, free, contact = model.displacements
        tree["displacement"] = {"nodes": (nodes, "m"), "free": (free, "m"), "contact": (contact, "-")}
    return tree


def checked(tree: dict[str, Any]) -> dict[str, Any]:
    """The fields of a model by name, from the tree of a file.

    Raises:
        ModelError: one line that names what is wrong and its limit.
    """
    p, cells, rates = len(tree["parameters"]), tree["answered"], tree["error"]["contact"]
    require(2 <= p <= MOST_PARAMETERS, f"parameters must be from 2 to {MOST_PARAMETERS}", p)
    cube = cells.size > 0 and cells.shape == (len(cells),) * p
    require(cube, f"cells must be as many along each of {p} parameters", cells.shape)
    parameters = [Parameter(**one) for one in tree["parameters"]]
    texts = [text for one in parameters for text in (one.name, one.unit)]
    require(all(isinstance(text, str) for text in texts), "parameters must have text as names and units", texts)
    lower, upper = ([getattr(one, end) for one in parameters] for end in ("lower", "upper"))
    ordered = bool(np.isfinite([lower, upper]).all() and np.less(lower, upper).all())
    require(ordered, "parameters must have finite lower ends below their upper ends", [*lower, *upper])
    require(0 <= tree["lead"] < p - 1, f"lead must be from 0 to {p - 2}", tree["lead"])
    scene = tree["scene"] | of_tables(tree["scene"])
    require(len(scene["tendons"]) == p - 1, f"tendons must be {p - 1}", len(scene["tendons"]))
    free = _form("free", tree["free"], p - 1, len(FREE), FREE)
    contact = _form("contact", tree["contact"], p, len(CONTACT) - 1, CONTACT)
    errors = tree["error"] | {"contact": rates.reshape(cells.size, -1)}
    shaped("error", errors["contact"], (cells.size, len(contact.modes) - 1), finite=False)
    least = [errors[name] for name in ("tip", "displacement", "touch_distance", "margin")]
    positive = bool(np.min([*least, *errors["contact"].ravel()]) >= 0) and np.isfinite(errors["margin"])
    require(positive, "error must be at least 0", "others")
    if "displacement" in tree:
        nodes = tree["displacement"]["nodes"]
        shaped("nodes", nodes, (len(nodes), 3))
        for name, form in (("free", free), ("contact", contact)):
            shaped(f"displacement by {name}", tree["displacement"][name], (nodes.size, form.terms))
    own = {name: tree[name] for name in (*PLAIN, "displacement") if name in tree}
    own |= {"scene": scene, "parameters": parameters}
    return own | {"free": free, "contact": contact, "answered": cells.ravel() != 0, "errors": errors}


def _tree(form: Separated, axes: list[tuple[str, str]], unit: str, names: Sequence[str]) -> dict[str, Any]:
    """A separated form for its file; `names` are those of its components."""
    units = [unit for _, unit in axes]
    described = {"components": list(names[: len(form.modes)]), "axes": [name for name, _ in axes]}
    arrays = {"modes": (form.modes, unit), "errors": (form.errors, "-"), "ends": (form.ends, ", ".join(units))}
    functions = zip(form.functions, units, strict=True)
    return described | arrays | {f"functions_{a}": (part, f"-, 1/{of}") for a, (part, of) in enumerate(functions)}


def _form(name: str, tree: dict[str, Any], axes: int, least: int, names: Sequence[str]) -> Separated:
    """A separated form from its file."""
    functions, (components, terms) = [tree[f"functions_{a}"] for a in range(axes)], tree["modes"].shape
    require(least <= components <= len(names), f"{name} must have {least} to {len(names)} components", components)
    require(1 <= terms <= MOST_TERMS, f"{name} must have from 1 to {MOST_TERMS} terms", terms)
    shaped(f"modes of {name}", tree["modes"], (components, terms))
    shaped(f"errors of {name}", tree["errors"], (terms,))
    shaped(f"ends of {name}", tree["ends"], (2, axes))
    require(bool((tree["ends"][0] < tree["ends"][1]).all()), f"ends of {name} must ascend", tree["ends"].tolist())
    for a, function in enumerate(functions):
        shaped(f"functions_{a} of {name}", function, (2, max(*function.shape[1:2], 2), terms))
    return Separated(ends=tree["ends"], functions=functions, modes=tree["modes"], errors=tree["errors"])
