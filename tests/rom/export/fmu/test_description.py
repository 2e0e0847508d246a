"""Descriptions of both versions of FMI: one interface, the same structure, and numbers that are not rounded."""

from pathlib import Path
from xml.etree.ElementTree import fromstring

import pytest

import rom
from rom.export.fmu.description import UNITS, build_description, fmi2, fmi3
from rom.export.fmu.variables import Interface, Variable, model_interface

TITLE = 'a "soft" <finger> & its Körper'
STIFFNESS = Variable(name="k", reference=7, causality="parameter", description="p", unit="m", start=0.1 + 0.2)


@pytest.fixture(scope="module")
def interface():
    own = model_interface(rom.load())
    variables = [*own.of("input"), STIFFNESS, *own.of("output")]
    return Interface(title=TITLE, units=[Path("a.c")], variables=variables, statuses=own.statuses, differentiable=True)


@pytest.fixture(scope="module")
def both(interface):
    return fromstring(fmi2(interface, "finger", "{t}", ["a.c", "b/c.c"])), fromstring(fmi3(interface, "finger", "{t}"))


def test_texts_survive_their_markup(both, interface):
    for root in both:
        assert root.get("description") == TITLE
        assert root.find("CoSimulation").get("modelIdentifier") == "finger"
        items = [(one.get("name"), int(one.get("value")), one.get("description")) for one in root.iter("Item")]
        assert items == interface.statuses
    assert both[0].get("guid") == both[1].get("instantiationToken") == "{t}"
    assert [one.get("name") for one in both[0].iter("File")] == ["a.c", "b/c.c"]


def test_both_versions_have_the_same_variables_and_bounds(both, interface):
    old = {one.get("name"): dict(one.attrib) | one[0].attrib for one in both[0].iter("ScalarVariable")}
    new = {one.get("name"): dict(one.attrib) for one in both[1].find("ModelVariables")}
    time = new.pop("time")
    assert time["causality"] == "independent" and time["valueReference"] == "0"
    assert old == new and list(old) == [one.name for one in interface.variables]
    assert float(old["k"]["start"]) == 0.1 + 0.2 and old["k"]["variability"] == "fixed"
    assert {one["unit"] for one in [*old.values(), time] if "unit" in one} <= set(UNITS)


def test_outputs_depend_on_all_inputs_and_in_the_beginning_on_parameters_too(both, interface):
    """FMI 2.0 counts variables from 1, FMI 3.0 has their value references."""
    numbers = [one.get("name") for one in both[0].iter("ScalarVariable")]
    by_index = {str(k): name for k, name in enumerate(numbers, 1)}
    by_reference = {str(one.reference): one.name for one in interface.variables}
    inputs, outputs = ([one.name for one in interface.of(kind)] for kind in ("input", "output"))
    structures = [
        (both[0].find("ModelStructure/Outputs"), both[0].find("ModelStructure/InitialUnknowns"), "index", by_index),
        (both[1].findall(".//Output"), both[1].findall(".//InitialUnknown"), "valueReference", by_reference),
    ]
    for found, initial, key, names in structures:
        for unknowns, known in ((found, inputs), (initial, [*inputs, "k"])):
            assert [names[one.get(key)] for one in unknowns] == outputs
            for one in unknowns:
                assert [names[number] for number in one.get("dependencies").split()] == known
                assert len(one.get("dependenciesKind").split()) == len(known)


def test_units_are_products_of_powers_that_agree_with_each_other(both):
    for root in both:
        found = {one.get("name"): dict(one[0].attrib) for one in root.iter("Unit")}
        pascal = {unit: int(found["N"].get(unit, 0)) - 2 * int(found["m"].get(unit, 0)) for unit in ("kg", "m", "s")}
        assert {unit: int(power) for unit, power in found["Pa"].items()} == pascal


def test_the_build_s_description_lists_every_source_once_and_its_options():
    root = fromstring(build_description("finger", ["x.c", "y & z.c"], "gcc", "-O2 -DA='\"b\"'"))
    assert [one.get("name") for one in root.iter("SourceFile")] == ["x.c", "y & z.c"]
    assert root.find(".//SourceFileSet").get("compilerOptions") == "-O2 -DA='\"b\"'"
    assert root.find("BuildConfiguration").get("modelIdentifier") == "finger"
