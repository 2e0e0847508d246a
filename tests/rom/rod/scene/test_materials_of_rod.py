"""Other materials of a rod's section: those of its elements, the mass of a section by closed forms, mirror images."""

from dataclasses import replace

import numpy as np
import pytest

from rom.elements.samples.symmetry import mirrors
from rom.files.checked_file import ModelError
from rom.rod.motion.branches import branches_of
from rom.rod.motion.lumps import lumps_of
from rom.rod.rod import Rod
from rom.rod.scene.materials_of_rod import line_mass
from rom.rod.scene.scene_of_rod import of_tables, rescaled, similarity
from rom.rod.weight import weight_of
from tests.rom.elements import elastic_rod

STIFF = {"law": "neo-hookean", "C1": 5e7, "D1": 4e-9}
CORE = {"name": "core", "region": "rectangle", "centre": [0.0, 0.0], "size": [0.002, 0.003], "material": STIFF}
LAYER = CORE | {"name": "layer", "centre": [-0.0045, 0.0], "size": [0.001, 0.010]}
OTHER = STIFF | {"C1": 6e7}
RUBBER, HEAVY = 1000.0, 8000.0  # [kg/m^3]


def scene(*materials: dict, **more) -> dict:
    return elastic_rod.scene() | {"materials": list(materials)} | more


@pytest.mark.parametrize(
    ("own", "rule"),
    [
        ([], "materials must be those of the elements, core, got none"),
        ([LAYER], "materials must be those of the elements, core, got layer"),
        ([CORE | {"region": "section"}], "materials.core.region must be 'rectangle', got 'section'"),
        ([CORE | {"size": [0.002, 0.002]}], r"materials.core.size must be \[0.002, 0.003\] m, got \[0.002, 0.002\]"),
        ([CORE | {"material": STIFF | OTHER}], "materials.core: material.D1 .* must be"),
        ([CORE | {"material": OTHER | {"D1": 4e-9 * 5 / 6}}], "materials.core: modulus over .* must be 1, .* got 1.2"),
    ],
)
def test_a_rod_has_the_materials_of_its_elements(own, rule):
    with pytest.raises(ModelError, match=rule):
        similarity(scene(CORE), scene(*own))


def test_all_materials_are_scaled_together():
    trained = scene(CORE, LAYER)
    found = similarity(trained, rescaled(trained, modulus=1.7, size=0.8))
    assert found[:2] == pytest.approx((0.8, 1.7))


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"materials": [CORE | {"x": [0.01, 0.05]}]}, r"materials.core.x must be left out .*, got \[0.01, 0.05\]"),
        ({"materials": [CORE | {"x": [0.0, np.nan]}]}, r"materials.core.x must be \[from, to\] with from < to"),
        ({"materials": [CORE | {"x": [0.02, 0.01]}]}, r"materials.core.x must be \[from, to\] with from < to"),
        ({"materials": [CORE, CORE]}, r"materials must differ in their names, got \['core', 'core'\]"),
        ({"materials": [CORE | {"density": -5.0}]}, "materials.core.density must be from 10 to 30000"),
        ({"materials": [CORE | {"density": np.nan}]}, "materials.core.density must be from 10"),
        ({"materials": [CORE | {"size": [0.002, np.nan]}]}, "materials.core.size must be two finite numbers"),
        ({"materials": [{"name": "core"}]}, "material is required in a table of the scene, and missing"),
    ],
)
def test_materials_are_complete_and_alike_along_the_axis(changes, rule):
    with pytest.raises(ModelError, match=rule):
        of_tables(scene(CORE) | changes)


def test_a_section_has_the_mass_of_its_materials():
    """A core of density H in a square of rubber R: masses and second moments of both rectangles add."""
    found = line_mass(scene(CORE | {"density": HEAVY}), RUBBER)
    square, core = elastic_rod.SIDE**2, 0.002 * 0.003
    mass = RUBBER * square + (HEAVY - RUBBER) * core
    squares = RUBBER * square * elastic_rod.SIDE**2 / 12 + (HEAVY - RUBBER) * core * np.array([0.002, 0.003]) ** 2 / 12
    assert found.density == pytest.approx(mass / square)
    assert found.squares == pytest.approx(squares / mass)
    with pytest.raises(ModelError, match=r"materials must have a centre of mass on the axis, .* y = -0\.00"):
        line_mass(scene(LAYER | {"density": HEAVY}), RUBBER)
    assert line_mass(scene(LAYER), RUBBER).density == RUBBER


def test_weight_and_moving_mass_are_those_of_the_materials(rod_elements):
    table = scene(CORE | {"density": HEAVY}, rubber={"E": elastic_rod.YOUNG, "nu": 0.3})
    gravity = {"density": RUBBER, "direction": [0.0, -1.0, 0.0]}
    rod = Rod(elements=replace(rod_elements, scene=table), scene=of_tables(table | {"gravity": gravity}))
    weight, lumps = weight_of(rod), lumps_of(rod, RUBBER, 7850.0)
    assert weight is not None
    moving = weight.masses.sum() - weight.masses[-1] / 2  # half of the last element is the clamp's
    assert lumps.masses.sum() == pytest.approx(moving)
    line = line_mass(rod.scene, RUBBER).density * elastic_rod.SIDE**2
    assert weight.masses[1:].sum() == pytest.approx(line * (elastic_rod.LENGTH - elastic_rod.PLATE))
    soft = rod.scene | {"material": rod.scene["material"] | {"prony": [[0.5, 1.0]]}}
    with pytest.raises(ModelError, match=r"material\.prony must be left out with several materials"):
        branches_of(rod.assembled(soft))


def test_mirror_images_exchange_the_materials():
    four = elastic_rod.scene(offsets=elastic_rod.FOUR)
    square = CORE | {"size": [0.002, 0.002]}
    for own, count in (([], 7), ([square], 7), ([CORE], 3), ([LAYER], 1), ([CORE | {"region": "group"}], 0)):
        assert len(mirrors(four | {"materials": own})) == count
