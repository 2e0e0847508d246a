"""docs/reference/scene.md says which keys a scene needs and what the others are without being written."""

import re
import tomllib
from copy import deepcopy
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from fingerfem.scene.scene import Scene
from fingerfem.scene.scene_table import SceneTable

PAGE = Path(__file__).resolve().parents[3] / "docs" / "reference" / "scene.md"
ROW = re.compile(r"^\| `([\w.]+)` \| .*? \| ([^|]*) \|$", re.MULTILINE)
DEFAULTS = {key: default.strip() for key, default in ROW.findall(PAGE.read_text())}

# The smallest scene of every kind.
SMALLEST = {
    "name": "smallest",
    "geometry": {"side": 0.01, "segments": [0.05], "plate": 0.001},
    "material": {"law": "neo-hookean", "C1": 1.9e6, "D1": 2.43e-7},
    "tendons": [{"name": "F1", "offset": [0.004, 0.0], "segment": 1, "tension": [0.0, 100.0]}],
    "mesh": {"cells": [20, 5]},
}
NO_SIDE = {"segments": [0.05], "plate": 0.001}
ELLIPSE = Path(__file__).with_name("sections") / "ellipse.msh"
DIGEST = sha256(ELLIPSE.read_bytes()).hexdigest()[:16]
PLANE = {"distance": [0.001, 0.031]}
PAD = {"name": "fingertip", "x": [0.049, 0.05]}
CHAMBER = {"name": "p1", "x": [0.002, 0.046], "pressure": [0.0, 2e4]}
KINDS: dict[str, dict[str, Any]] = {
    "smallest": {},
    "mooney-rivlin": {"material": {"law": "mooney-rivlin", "C10": 1e6, "C01": 1e5, "D1": 2.43e-7}},
    "saint-venant-kirchhoff": {"material": {"law": "saint-venant-kirchhoff", "E": 1e7, "nu": 0.3}},
    "yeoh": {"material": {"law": "yeoh", "C1": 1e6, "D1": 2.43e-7}},
    "ogden": {"material": {"law": "ogden", "mu": [1e6], "alpha": [1.3], "D1": 2.43e-7}},
    "moduli": {"material": {"law": "yeoh", "E": 1e7, "nu": 0.3}},
    "hardness": {"material": {"law": "yeoh", "shore_A": 30.0}},
    "plane": {"obstacle": PLANE},
    "pad": {"obstacle": PLANE | {"pad": PAD}},
    "tilted plane": {"obstacle": PLANE | {"centre": [0.05, 0.02, 0.0]}},
    "sphere": {"obstacle": PLANE | {"shape": "sphere", "centre": [0.05, 0.02, 0.0], "radius": 0.01}},
    "cylinder": {
        "obstacle": PLANE | {"shape": "cylinder", "centre": [0.05, 0.02, 0.0], "radius": 0.01, "axis": [0.0, 0.0, 1.0]}
    },
    "box": {"obstacle": PLANE | {"shape": "box", "centre": [0.05, 0.02, 0.0], "sides": [0.01] * 3, "rounding": 0.001}},
    "chambers": {"chambers": [CHAMBER | {"region": "rectangle", "centre": [-0.002, 0.0], "size": [0.002, 0.002]}]},
    "bore": {
        "section": {"shape": "ring", "diameter": 0.012, "bore": 0.003},
        "geometry": NO_SIDE,
        "chambers": [CHAMBER | {"region": "bore"}],
    },
    "section of another material": {
        "materials": [{"name": "joint", "region": "section", "material": {"law": "neo-hookean", "E": 1e8, "nu": 0.3}}]
    },
    "layer": {
        "materials": [
            {"name": "layer", "region": "rectangle", "centre": [-0.002, 0.0], "size": [0.002, 0.002]}
            | {"material": {"law": "neo-hookean", "E": 1e8, "nu": 0.3}}
        ]
    },
    "weight": {"gravity": {"density": 1070.0, "direction": [0.0, -1.0, 0.0]}},
    "density": {"density": {"rubber": 1070.0}},
    "load": {"load": {"force": 5.0}},
    "coarse": {"coarse": {"cells": [10, 5]}},
    "square": {"section": {"shape": "square", "side": 0.01}, "geometry": NO_SIDE},
    "rectangle": {"section": {"shape": "rectangle", "height": 0.01, "width": 0.008}, "geometry": NO_SIDE},
    "circle": {"section": {"shape": "circle", "diameter": 0.0125}, "geometry": NO_SIDE | {"channel": 0.002}},
    "ring": {"section": {"shape": "ring", "diameter": 0.012, "bore": 0.003}, "geometry": NO_SIDE},
    "file": {"section": {"file": str(ELLIPSE)}, "geometry": NO_SIDE, "mesh": {"cells": [20, 1]}},
}
# Of keys that may be added: the kind of scene they are added to, if not the smallest, and a value.
ADDED: dict[str, tuple[str, Any]] = {
    "geometry.channel": ("smallest", 0.002),
    "geometry.taper": ("smallest", [0.9]),
    "material.C2": ("yeoh", 1e4),
    "material.C3": ("yeoh", 1e3),
    "material.stretches": ("smallest", [0.6, 2.0]),
    "material.prony": ("smallest", [[0.2, 0.01]]),
    "material.formulation": ("smallest", "mixed"),
    "materials.x": ("layer", [0.01, 0.02]),
    "materials.density": ("layer", 1200.0),
    "tendons.path": ("smallest", "straight"),
    "density.plates": ("density", 8000.0),
    "gravity.plate_density": ("weight", 8000.0),
    "gravity.acceleration": ("weight", 1.62),
    "obstacle.shape": ("plane", "plane"),
    "obstacle.centre": ("plane", [0.05, 0.02, 0.0]),
    "obstacle.direction": ("plane", [0.1, 1.0, 0.0]),
    "obstacle.normal": ("tilted plane", [0.1, -1.0, 0.0]),
    "obstacle.rotation": ("box", [0.1, 0.2, 0.3]),
    "obstacle.method": ("plane", "nitsche"),
    "obstacle.stiffness": ("plane", 1000.0),
    "obstacle.others": ("plane", [{"shape": "sphere", "centre": [0.05, -0.02, 0.0], "radius": 0.01}]),
    "obstacle.pad.width": ("pad", 0.006),
    "load.friction_angle": ("load", 0.4),
    "load.moment": ("load", 0.05),
    "load.reach": ("load", 0.02),
    "mesh.order": ("smallest", 2),
    "mesh.symmetry": ("smallest", False),
    "coarse.order": ("coarse", 2),
    "coarse.lines": ("coarse", 8),
    "section.digest": ("file", DIGEST),
    "sampling.lines": ("smallest", 8),
    "sampling.tension_nodes": ("smallest", 7),
    "sampling.contact_nodes": ("smallest", 7),
    "sampling.wrenches": ("smallest", 2),
    "sampling.store": ("smallest", ["channel_shortening"]),
}
CHOICES = {"accuracy": "5 %", "budget": "20min", "preset": "draft"}  # in place of mesh.cells
BY_PROGRAM = {"expected"}
PLAIN = re.compile(r'\[.*\]|-?[\d.]+|plane|channel|penalty|"\w+"')


def scene(kind: str) -> dict:
    return deepcopy(SMALLEST | KINDS[kind])


def table_of(whole: dict, key: str) -> tuple[dict, str]:
    """The table that a key stands in, made where it is missing, and the key's own name."""
    *tables, name = key.split(".")
    for one in tables:
        whole = whole.setdefault(one, {})
        whole = whole[0] if isinstance(whole, list) else whole
    return whole, name


def has(whole: dict, key: str) -> bool:
    table, name = table_of(whole, key)
    return name in table


REQUIRED = sorted(key for key, default in DEFAULTS.items() if default.startswith("required"))
OPTIONAL = sorted(DEFAULTS.keys() - set(REQUIRED) - BY_PROGRAM - CHOICES.keys())


@pytest.mark.parametrize("kind", KINDS)
def test_the_smallest_scenes_are_accepted(kind):
    Scene.model_validate(scene(kind))


@pytest.mark.parametrize("key", REQUIRED)
def test_a_key_that_the_page_calls_required_is_refused_where_it_is_missing(key):
    needed = [kind for kind in KINDS if not ("except of a plane" in DEFAULTS[key] and "plane" in kind)]
    kinds = [kind for kind in needed if has(scene(kind), key)]
    assert kinds
    for kind in kinds:
        whole = scene(kind)
        table, name = table_of(whole, key)
        del table[name]
        with pytest.raises(ValidationError, match=r"[Ff]ield required|must be given|is required and missing"):
            Scene.model_validate(whole)


@pytest.mark.parametrize("key", OPTIONAL)
def test_a_key_that_the_page_gives_a_default_may_be_added_and_is_that_without(key):
    kind, value = ADDED[key]
    before = Scene.model_validate(scene(kind))
    whole = scene(kind)
    table, name = table_of(whole, key)
    assert name not in table
    table[name] = value
    Scene.model_validate(whole)
    if PLAIN.fullmatch(DEFAULTS[key]):
        (default,) = tomllib.loads(f"x = {literal(DEFAULTS[key])}").values()
        table[name] = default
        written = Scene.model_validate(whole)
        assert attribute(before, key) == attribute(written, key) == default
        assert written.fingerprint() == before.fingerprint()


def literal(text: str) -> str:
    return text if re.match(r'[\[\d"-]', text) else f'"{text}"'


def attribute(one: Any, key: str) -> Any:
    for name in key.split("."):
        one = getattr(one[0] if isinstance(one, list) else one, name)
    return one


@pytest.mark.parametrize("key", CHOICES)
def test_a_choice_stands_in_for_the_mesh(key):
    whole = scene("smallest")
    del whole["mesh"]
    with pytest.raises(ValidationError, match="Field required"):
        Scene.model_validate(whole)
    assert Scene.model_validate(whole | {key: CHOICES[key]}).mesh.cells


@pytest.mark.parametrize("key", sorted(DEFAULTS.keys() - set(CHOICES)))
def test_an_unknown_key_is_refused_at_every_level_and_in_every_table_of_a_list(key):
    kinds = [kind for kind in KINDS if has(scene(kind), key)]
    whole = scene(ADDED[key][0] if key in ADDED else kinds[0] if kinds else "smallest")
    if key.startswith("tendons"):
        whole["tendons"] = [*whole["tendons"], whole["tendons"][0] | {"name": "F2", "offset": [-0.004, 0.0]}]
        table = whole["tendons"][1]
    else:
        table, _ = table_of(whole, key)
    Scene.model_validate(whole)
    table["unheard_of"] = 1
    with pytest.raises(ValidationError, match=r"unheard_of\n  Extra inputs are not permitted"):
        Scene.model_validate(whole)


def test_every_table_refuses_unknown_keys():
    def tables(one: type[BaseModel]) -> set[type[BaseModel]]:
        return {one}.union(*map(tables, one.__subclasses__()))

    assert len(tables(SceneTable)) > 10
    assert all(one.model_config["extra"] == "forbid" and one.model_config["strict"] for one in tables(SceneTable))


@pytest.mark.parametrize("kind", ["tilted plane", "sphere", "cylinder", "box"])
def test_only_the_plane_before_the_finger_needs_a_distance_above_zero(kind):
    whole = scene(kind)
    whole["obstacle"]["distance"] = [-0.03, 0.02]
    assert Scene.model_validate(whole).parameters[-1]["lower"] == -0.03
    with pytest.raises(ValidationError, match=r"distance.0 must be above 0 m for the plane y = side/2 \+ d, got -0.03"):
        Scene.model_validate(scene("plane") | {"obstacle": {"distance": [-0.03, 0.02]}})
