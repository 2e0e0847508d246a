"""modelDescription.xml of FMI 2.0 and 3.0, and FMI 3.0's buildDescription.xml."""

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from rom.export.fmu.variables import Interface, Variable

UNITS = {
    "m": {"m": "1"},
    "m3": {"m": "3"},
    "N": {"kg": "1", "m": "1", "s": "-2"},
    "Pa": {"kg": "1", "m": "-1", "s": "-2"},
    "s": {"s": "1"},
    "rad": {"rad": "1"},
}
STATUS_TYPE = "Status"
TOOL = "fingerfem"
STEP = "0.01"  # [s]: of the experiment that a tool proposes


def text(root: Element) -> bytes:
    """A document."""
    indent(root)
    return tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def fmi2(interface: Interface, name: str, token: str, sources: Sequence[str]) -> bytes:
    """modelDescription.xml of FMI 2.0.

    Args:
        interface: what it shows.
        name: the model's identifier.
        token: its GUID.
        sources: C files to compile, seen from sources/.
    """
    root = Element("fmiModelDescription", {"fmiVersion": "2.0", "guid": token} | _about(interface, name))
    kind = _add(
        root,
        "CoSimulation",
        modelIdentifier=name,
        canHandleVariableCommunicationStepSize="true",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        providesDirectionalDerivative=_boolean(interface.differentiable),
    )
    files = _add(kind, "SourceFiles")
    for source in sources:
        _add(files, "File", name=source)
    _units(root)
    _items(_add(_add(root, "TypeDefinitions"), "SimpleType", name=STATUS_TYPE), "Enumeration", interface)
    _logging(root)
    variables = _add(root, "ModelVariables")
    for one in interface.variables:
        scalar = _add(variables, "ScalarVariable", **_common(one))
        _add(scalar, one.kind, **_own(one))
    indices = {one.name: str(k) for k, one in enumerate(interface.variables, 1)}
    structure = _add(root, "ModelStructure")
    outputs, unknowns = _add(structure, "Outputs"), _add(structure, "InitialUnknowns")
    for one in interface.of("output"):
        _add(outputs, "Unknown", index=indices[one.name], **_dependencies(interface, indices))
        _add(unknowns, "Unknown", index=indices[one.name], **_dependencies(interface, indices, initial=True))
    return text(root)


def fmi3(interface: Interface, name: str, token: str) -> bytes:
    """modelDescription.xml of FMI 3.0, see `fmi2`."""
    root = Element("fmiModelDescription", {"fmiVersion": "3.0", "instantiationToken": token} | _about(interface, name))
    _add(
        root,
        "CoSimulation",
        modelIdentifier=name,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
        providesDirectionalDerivatives=_boolean(interface.differentiable),
    )
    _units(root)
    _items(_add(root, "TypeDefinitions"), "EnumerationType", interface, name=STATUS_TYPE)
    _logging(root)
    variables = _add(root, "ModelVariables")
    _add(
        variables,
        "Float64",
        name="time",
        valueReference="0",
        causality="independent",
        variability="continuous",
        unit="s",
        description="simulated time",
    )
    for one in interface.variables:
        _add(variables, {"Real": "Float64"}.get(one.kind, one.kind), **_common(one), **_own(one))
    references = {one.name: str(one.reference) for one in interface.variables}
    structure = _add(root, "ModelStructure")
    for tag in ("Output", "InitialUnknown"):
        for one in interface.of("output"):
            needed = _dependencies(interface, references, initial=tag != "Output")
            _add(structure, tag, valueReference=references[one.name], **needed)
    return text(root)


def build_description(name: str, sources: Sequence[str], compiler: str, options: str) -> bytes:
    """buildDescription.xml of FMI 3.0: how the C files in sources/ are compiled."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = _add(root, "BuildConfiguration", modelIdentifier=name)
    files = _add(configuration, "SourceFileSet", language="C99", compiler=compiler, compilerOptions=options)
    for source in sources:
        _add(files, "SourceFile", name=source)
    _add(configuration, "Library", name="m", external="true", description="the C library's mathematics")
    return text(root)


def _add(parent: Element, tag: str, **attributes: str) -> Element:
    return SubElement(parent, tag, attributes)


def _about(interface: Interface, name: str) -> dict[str, str]:
    return {
        "modelName": name,
        "description": interface.title,
        "generationTool": TOOL,
        "variableNamingConvention": "flat",
    }


def _units(root: Element) -> None:
    units = _add(root, "UnitDefinitions")
    for unit, powers in UNITS.items():
        _add(_add(units, "Unit", name=unit), "BaseUnit", **powers)


def _items(parent: Element, tag: str, interface: Interface, **attributes: str) -> None:
    """The enumeration of the statuses."""
    kind = _add(parent, tag, **attributes)
    for name, value, meaning in interface.statuses:
        _add(kind, "Item", name=name, value=str(value), description=meaning)


def _logging(root: Element) -> None:
    """Adds the category of log messages, and the experiment that a tool proposes."""
    _add(_add(root, "LogCategories"), "Category", name="logStatusError", description="what was refused")
    _add(root, "DefaultExperiment", startTime="0", stopTime="1", stepSize=STEP)


def _common(one: Variable) -> dict[str, str]:
    """Attributes of a variable that both versions of FMI name alike."""
    variability = {"parameter": "fixed"}.get(one.causality, "discrete" if one.discrete else "continuous")
    attributes = {
        "name": one.name,
        "valueReference": str(one.reference),
        "causality": one.causality,
        "variability": variability,
        "description": one.description,
    }
    initial = {"output": "calculated", "parameter": "exact"}.get(one.causality)
    return attributes | ({"initial": initial} if initial else {})


def _own(one: Variable) -> dict[str, str]:
    """Attributes of a variable that belong to its type."""
    if one.kind == "Enumeration":
        return {"declaredType": STATUS_TYPE}
    numbers = {"min": one.lower, "max": one.upper, "start": one.start}
    attributes = {name: repr(float(value)) for name, value in numbers.items() if value is not None}
    return ({"unit": one.unit} if one.unit else {}) | attributes


def _dependencies(interface: Interface, names: dict[str, str], initial: bool = False) -> dict[str, str]:
    """Every output depends on every input, and in the beginning on parameters."""
    known = interface.of("input") + (interface.of("parameter") if initial else [])
    return {
        "dependencies": " ".join(names[one.name] for one in known),
        "dependenciesKind": " ".join("dependent" for _ in known),
    }


def _boolean(value: bool) -> str:
    return "true" if value else "false"
