"""Random scenes: sections, laws, sizes, loads scaled to the stiffness, and what else a scene may have."""

from __future__ import annotations

from typing import Any

import numpy as np

from fingerfem.scene.laws import REGISTERED
from fingerfem.scene.sections import SHAPES, Section

Table = dict[str, Any]
SEED = 42
ACROSS = 5  # cells
SIDES, STIFFNESS = (3e-3, 0.1), (5e3, 5e6)  # largest extent of a section [m], C1 or half the shear modulus [Pa]
POISSON = (0.3, 0.45, 0.49, 0.499, 0.4999)
SLENDERNESS, TURN = (2.5, 6.0), (0.2, 2.0)  # length over extent [-]; of the tip by all tensions [rad]
SHARES = {"taper": 0.3, "weight": 0.4, "layer": 0.3, "chamber": 0.3, "order 2": 0.1}  # of fingers that have it


def finger(number: int) -> tuple[Table, list[float]]:
    """A scene on few cells, and the tensions [N] and pressures [Pa] that it is solved at."""
    random = np.random.default_rng([SEED, number])
    extent, slenderness = _log(random, SIDES), float(random.uniform(*SLENDERNESS))
    names = sorted(SHAPES)
    section = _section(random, names[number % len(names)], extent)
    shape = SHAPES[section["shape"]].model_validate(section)
    material, young = _material(random, sorted(REGISTERED)[number // len(names) % len(REGISTERED)])
    has = {name: bool(random.random() < share) for name, share in SHARES.items()}
    length = slenderness * extent
    geometry: Table = {"segments": [length], "plate": float(random.uniform(0.02, 0.2)) * extent}
    if has["taper"]:
        geometry["taper"] = [float(random.uniform(0.6, 1.1))]
    tendons, pulled = _tendons(random, shape, young, length)
    along = int(np.ceil(1.6 * length / shape.depth / min([1.0, *geometry.get("taper", [])]))) + 1
    table: Table = {"name": f"random {number}", "section": section, "geometry": geometry, "material": material}
    table |= {"tendons": tendons, "mesh": {"cells": [along, ACROSS], "order": 2 if has["order 2"] else 1}}
    if has["weight"]:
        table["gravity"] = {"density": float(random.uniform(900, 1300)), "direction": random.normal(size=3).tolist()}
    if has["layer"]:
        table["materials"] = [_layer(random, shape, young, length)]
    if has["chamber"] and shape.chamber_region is not None:
        chamber = _chamber(random, shape, young, length - geometry["plate"])
        table["chambers"] = [chamber]
        pulled.append(float(random.uniform(0.2, 1.0)) * chamber["pressure"][1])
    return table, pulled


def _log(random: np.random.Generator, limits: tuple[float, float]) -> float:
    return float(np.exp(random.uniform(*np.log(limits))))


def _section(random: np.random.Generator, shape: str, extent: float) -> Table:
    small = float(random.uniform(0.3, 0.8)) * extent
    height, width = random.permutation([extent, small]).tolist()
    measures: dict[str, Table] = {
        "square": {"side": extent},
        "rectangle": {"height": height, "width": width},
        "circle": {"diameter": extent},
        "ring": {"diameter": extent, "bore": small},
    }
    return measures[shape] | {"shape": shape}


def _material(random: np.random.Generator, name: str) -> tuple[Table, float]:
    """A law's table, and Young's modulus at small strain [Pa]; some have no stability, or no such Poisson's ratio."""
    C1, nu = _log(random, STIFFNESS), float(random.choice(POISSON))
    sign = 1 if random.random() < 0.8 else -1
    more: dict[str, Table] = {
        "mooney-rivlin": {"C01": float(sign * C1 * random.uniform(0, 0.5))},
        "ogden": {"alpha": [float(random.choice([-4.0, -2.0, 1.3, 2.0, 3.6, 6.0]))]},
        "yeoh": {"C2": float(sign * C1 * random.uniform(0, 0.3)), "C3": float(C1 * random.uniform(0, 0.03))},
    }
    young = 4 * C1 * (1 + nu)
    return {"law": name, "E": young, "nu": nu} | more.get(name, {}), young


def _tendons(
    random: np.random.Generator, shape: Section, young: float, length: float
) -> tuple[list[Table], list[float]]:
    """One to four tendons on the axes of the section, which turn the tip by some TURN together; their tensions [N]."""
    inner = getattr(shape, "hollow", 0.0) / min(shape.extents)
    radius = min(shape.extents) / 2 * float(random.uniform(0.5, 0.8) if not inner else (1 + inner) / 2)
    places = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])[random.permutation(4)[: random.integers(1, 5)]]
    turns = float(random.uniform(*TURN)) * random.dirichlet(np.ones(len(places)))
    tensions = (turns * young * shape.second_moment / (radius * length)).tolist()
    tendons = [
        {"name": f"F{k}", "offset": (radius * place).tolist(), "segment": 1, "tension": [0.0, 1.5 * pull + 1e-9]}
        for k, (place, pull) in enumerate(zip(places, tensions, strict=True), 1)
    ]
    return tendons, tensions


def _layer(random: np.random.Generator, shape: Section, young: float, length: float) -> Table:
    """A layer in the lower face of a square or rectangle, or else a joint across the whole section."""
    law = {"law": "neo-hookean", "E": min(young * _log(random, (0.1, 1e3)), 1e11), "nu": 0.3}
    if shape.chamber_region != "rectangle":
        begin = float(random.uniform(0.2, 0.5)) * length
        return {"name": "joint", "region": "section", "x": [begin, begin + 0.2 * length], "material": law}
    height, width = shape.extents
    thick = float(random.uniform(0.05, 0.3)) * height
    place = {"centre": [(thick - height) / 2, 0.0], "size": [thick, width]}
    return {"name": "layer", "region": "rectangle", "material": law} | place


def _chamber(random: np.random.Generator, shape: Section, young: float, length: float) -> Table:
    """A rectangle on the axis, or the bore of a ring, along most of the rubber."""
    x = [0.1 * length, float(random.uniform(0.5, 0.9)) * length]
    chamber = {"name": "p1", "region": shape.chamber_region, "x": x, "pressure": [0.0, 0.1 * young]}
    if shape.chamber_region == "bore":
        return chamber
    size = (float(random.uniform(0.1, 0.5)) * np.array(shape.extents)).tolist()
    return chamber | {"centre": [0.0, 0.0], "size": size}
