"""repr of whatever holds many numbers is one line."""

from dataclasses import fields, is_dataclass
from importlib import import_module
from inspect import isclass
from pkgutil import walk_packages

import numpy as np
import pytest

import control
import rom
from control import Finger, Gripper, Limits, SimulatedPlant
from rom import Rod, TouchedSegment
from rom.brief import brief
from rom.rod.objects.shapes import box
from rom.rod.touched_segment import SHIPPED

MANY = (
    "ndarray",
    "ArrayLike",
    "Sequence",
    "list[",
    "dict[",
    "Mapping",
    "Rod",
    "Elements",
    "SeparatedModel",
    "Polynomial",
)
MOST = 400  # characters


def classes():
    """All public dataclasses and named tuples of rom and control that can hold many numbers."""
    for package in (rom, control):
        for found in walk_packages(package.__path__, f"{package.__name__}."):
            if found.name.endswith(("__main__", "browser", "browser.build")):
                continue
            try:
                module = import_module(found.name)
            except ImportError:  # an optional package
                continue
            for name, one in vars(module).items():
                plain = not isclass(one) or one.__module__ != found.name or name.startswith("_")
                if plain or not (is_dataclass(one) or hasattr(one, "_fields")):
                    continue
                kinds = [str(each.type) for each in fields(one)] if is_dataclass(one) else one.__annotations__.values()
                if any(word in str(kind) for kind in kinds for word in MANY):
                    yield pytest.param(one, id=f"{found.name}.{name}")


@pytest.mark.parametrize("one", list(classes()))
def test_a_class_that_holds_many_numbers_has_a_brief_repr(one):
    assert one.__repr__ is brief(type("Some", (), {})).__repr__


def line(thing: object) -> str:
    text = repr(thing)
    assert text.startswith(f"{type(thing).__name__}(") and "\n" not in text and len(text) <= MOST, text
    return text


def test_a_model_names_its_scene_and_its_parameters_in_one_line(table):
    rod, touched = Rod.load(SHIPPED), TouchedSegment.load()
    models = [table, rod, touched]
    for model in models:
        text = line(model)
        assert repr(model.scene["name"]) in text and "F1 0 to 100 N" in text
    assert " to 0.031 m" in line(table)
    assert (
        line(rod.elements)
        and line(rod.segments[0])
        and line(rod.segments[0].elements[0])
        and line(table.free)
        and line(table.errors)
    )


def test_answers_motions_and_grasps_are_one_line_at_one_point_and_at_many(table):
    point, many = [30.0, 5.0, 0.010], np.tile([30.0, 5.0, 0.010], (1000, 1))
    for model in (table, TouchedSegment.load()):
        assert "contact_force=" in line(model.evaluate(point)) and "(1000, 3)" in line(model.evaluate(many))
        finger = Finger(model)
        assert "status='converged'" in line(finger.hold(1.0, 0.010))
    gripper = Gripper(table)
    plants = [SimulatedPlant(table, distance) for distance in gripper.distances((0.0, 0.0), 0.012)]
    grasp = gripper.grasp(1.0, plants)
    assert line(grasp) and line(grasp.history[-1])
    touched = TouchedSegment.load()
    assert line(touched.rod.place([30.0, 0.0])) and all(map(line, touched.contact_forces(point)))
    assert line(Limits(upper=np.full(8, 20.0)))


def test_the_fields_of_what_is_not_a_model_are_shown_briefly():
    solid = box(centre=(0.1, 0.0, 0.0), sides=(0.01, 0.02, 0.03), direction=(0.0, 1.0, 0.0))
    assert "vertices=" in line(solid)
