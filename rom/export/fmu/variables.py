"""The variables of a finger's FMU, by what the C in native/ has: value references, and what statuses mean."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rom.brief import brief
from rom.files.checked_file import ModelError
from rom.parameter import Parameter
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel

INPUTS, OUTPUTS, FLAG, STATUS = 1, 101, 201, 202  # value references, as in native/fmu.h
REPORT, REPORT_ERRORS = OUTPUTS + 10, OUTPUTS + 22  # of a model of elements, as in native/fmu_model.c
MOST_INPUTS = 10  # as in native/fmu.h
MEANING = {"m": "distance of the object", "N": "tension of a tendon", "Pa": "pressure in a chamber"}  # by unit
UNKNOWN = "the largest number where it is not known"


@dataclass(frozen=True, kw_only=True)
class Variable:
    """One variable.

    Attributes:
        name: its own.
        reference: its value reference.
        causality: input, output or parameter.
        description: one line.
        kind: Real, Boolean or Enumeration.
        unit: of a Real.
        lower: end of what was trained, if there is one.
        upper: likewise.
        start: of what is no output.
        discrete: an output that jumps: it has no derivatives.
    """

    name: str
    reference: int
    causality: str
    description: str
    kind: str = "Real"
    unit: str = ""
    lower: float | None = None
    upper: float | None = None
    start: float | None = None
    discrete: bool = False


@brief
@dataclass(frozen=True, kw_only=True)
class Interface:
    """Interface of an FMU: its variables, and the C files that compute them.

    Attributes:
        title: one line.
        units: the C files that answer, besides those of an FMU and of models.
        variables: inputs, parameters, then outputs.
        statuses: names, numbers and meanings of the status.
        differentiable: whether there are derivatives of what is continuous.
    """

    title: str
    units: Sequence[Path]
    variables: list[Variable]
    statuses: list[tuple[str, int, str]] = field(default_factory=list)
    differentiable: bool = False

    def of(self, causality: str) -> list[Variable]:
        """The variables of a causality."""
        return [one for one in self.variables if one.causality == causality]


def model_interface(model: SeparatedModel | TouchedSegment) -> Interface:
    """Tensions and distance in; all answers of the model out.

    Raises:
        ModelError: more parameters than the C has room for.
    """
    if len(model.parameters) > MOST_INPUTS:
        raise ModelError(f"model must have at most {MOST_INPUTS} parameters for an FMU, got {len(model.parameters)}")
    inputs = [input_of(one, INPUTS + k) for k, one in enumerate(model.parameters)]
    rows = [("tip_x", "m", "displacement of the tip along the finger"), ("tip_y", "m", "of the tip along y")]
    rows += [("tip_z", "m", "of the tip along z")]
    errors = [("tip_error", "m", "estimated error of the tip"), None, None, None]
    if model.has_obstacle:
        rows += [("contact_force", "N", "contact force"), ("touch_distance", "m", "d at which the free finger touches")]
        errors[1] = ("contact_force_error", "N", "estimated error of the contact force")
        errors[2] = ("touch_distance_error", "m", "estimated error of the touch distance")
    if model.has_pad:
        rows.append(("pad_pressure", "Pa", "largest pressure on the pad"))
        errors[3] = ("pad_pressure_error", "Pa", "estimated error of the pad's pressure")
    outputs = [output_of(*row, OUTPUTS + k) for k, row in enumerate(rows)]
    outputs += [
        output_of(name, unit, f"{text}; {UNKNOWN}", OUTPUTS + 6 + k, discrete=True)
        for k, (name, unit, text) in ((k, row) for k, row in enumerate(errors) if row)
    ]
    if isinstance(model, TouchedSegment):
        outputs += _reported(model)
    return Interface(
        title=f"{model.scene['name']}: a rubber finger, and what it touches",
        units=[Path(__file__).parent / "native" / "fmu_model.c"],
        variables=[*inputs, *outputs, *flags_of("inside", "the answer is to be relied on: status is inside")],
        statuses=[
            ("inside", 0, "inside of what was trained"),
            ("no_equilibrium", 1, "no equilibrium was found"),
            ("beyond", 2, "beyond what was trained, not stable, or an input is no number"),
        ],
        differentiable=True,
    )


def _reported(model: TouchedSegment) -> list[Variable]:
    """The tip's orientation, the tendons' shortenings and the chambers' growths."""
    loads, about = (
        model.parameters[: -len(model.objects)],
        "of the tip plate's unit quaternion, w >= 0: its sign changes at half a turn",
    )
    rows = [(f"orientation_{axis}", "", f"{axis} {about}") for axis in "wxyz"]
    rows += [
        (f"shortening_{one.name}", "m", f"how much shorter {one.name} is from clamp to plate")
        if one.unit == "N"
        else (f"growth_{one.name}", "m3", f"how much larger the chamber {one.name} is")
        for one in loads
    ]
    errors = [
        ("orientation_error", "rad", "estimated error of the orientation, an angle"),
        ("shortening_error", "m", "estimated error of every shortening"),
    ]
    outputs = [output_of(*row, REPORT + k) for k, row in enumerate(rows)]
    return outputs + [
        output_of(name, unit, f"{text}; {UNKNOWN}", REPORT_ERRORS + k, discrete=True)
        for k, (name, unit, text) in enumerate(errors)
    ]


def input_of(parameter: Parameter, reference: int) -> Variable:
    """The input of a model's parameter: tensions and pressures start gently, the object far away."""
    is_distance = parameter.unit == "m"
    return Variable(
        name=parameter.name,
        reference=reference,
        causality="input",
        description=MEANING[parameter.unit],
        unit=parameter.unit,
        lower=parameter.lower,
        upper=parameter.upper,
        start=parameter.upper if is_distance else parameter.lower,
    )


def output_of(name: str, unit: str, description: str, reference: int, discrete: bool = False) -> Variable:
    """A Real output."""
    return Variable(
        name=name, reference=reference, causality="output", description=description, unit=unit, discrete=discrete
    )


def flags_of(name: str, description: str) -> list[Variable]:
    """Variables for the validity of an answer: a flag, and the status with the reason."""
    return [
        Variable(name=name, reference=FLAG, causality="output", description=description, kind="Boolean", discrete=True),
        Variable(
            name="status",
            reference=STATUS,
            causality="output",
            description=f"whether, or why not, {name}",
            kind="Enumeration",
            discrete=True,
        ),
    ]
