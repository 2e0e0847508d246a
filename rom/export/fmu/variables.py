"""The variables of a finger's FMU, by what the C in native/ has: value references, and what statuses mean."""

from __future__ import annotations

from dataclasses import dataclass, field

from rom.brief import brief
from rom.checked_file import ModelError
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel

INPUTS, OUTPUTS, FLAG, STATUS = 1, 101, 201, 202  # value references, as in native/fmu.h
REPORT, REPORT_ERRORS = OUTPUTS + 10, OUTPUTS + 22  # of a model of elements, as in native/fmu_model.c
RESIDUAL, FORCE_ERROR = OUTPUTS + 8, OUTPUTS + 9  # of a controller, as in native/fmu_controller.c
MOST_INPUTS, MOST_TENSIONS = 10, 8  # likewise
HELD = 1.0  # [N]: the contact force that a controller begins with
TENSION = "tension that holds, or comes nearest; out_of_domain keeps the last step's"
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
    """What an FMU shows.

    Attributes:
        title: one line.
        unit: the C file in native/ that answers.
        variables: inputs, parameters, then outputs.
        statuses: names, numbers and meanings of the status.
        differentiable: whether there are derivatives of what is continuous.
    """

    title: str
    unit: str
    variables: list[Variable]
    statuses: list[tuple[str, int, str]] = field(default_factory=list)
    differentiable: bool = False

    def of(self, causality: str) -> list[Variable]:
        """The variables of a causality."""
        return [one for one in self.variables if one.causality == causality]


def model_interface(model: SeparatedModel | TouchedSegment) -> Interface:
    """Tensions and distance in; all that the model tells out.

    Raises:
        ModelError: more parameters than the C has room for.
    """
    if len(model.parameters) > MOST_INPUTS:
        raise ModelError(f"model must have at most {MOST_INPUTS} parameters for an FMU, got {len(model.parameters)}")
    inputs = [_input(one, INPUTS + k) for k, one in enumerate(model.parameters)]
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
    outputs = [_output(*row, OUTPUTS + k) for k, row in enumerate(rows)]
    outputs += [
        _output(name, unit, f"{text}; {UNKNOWN}", OUTPUTS + 6 + k, discrete=True)
        for k, (name, unit, text) in ((k, row) for k, row in enumerate(errors) if row)
    ]
    if isinstance(model, TouchedSegment):
        outputs += _reported(model)
    return Interface(
        title=f"{model.scene['name']}: a rubber finger, and what it touches",
        unit="fmu_model.c",
        variables=[*inputs, *outputs, *_flags("inside", "the answer is to be relied on: status is inside")],
        statuses=[
            ("inside", 0, "inside of what was trained"),
            ("no_equilibrium", 1, "no equilibrium was found"),
            ("beyond", 2, "beyond what was trained, not stable, or an input is no number"),
        ],
        differentiable=True,
    )


def _reported(model: TouchedSegment) -> list[Variable]:
    """The tip's orientation and the tendons' shortenings."""
    tendons, about = model.names[:-1], "of the tip plate's unit quaternion, w >= 0: its sign changes at half a turn"
    rows = [(f"orientation_{axis}", "", f"{axis} {about}") for axis in "wxyz"]
    rows += [(f"shortening_{name}", "m", f"how much shorter {name} is from clamp to plate") for name in tendons]
    errors = [
        ("orientation_error", "rad", "estimated error of the orientation, an angle"),
        ("shortening_error", "m", "estimated error of every shortening"),
    ]
    found = [_output(*row, REPORT + k) for k, row in enumerate(rows)]
    return found + [
        _output(name, unit, f"{text}; {UNKNOWN}", REPORT_ERRORS + k, discrete=True)
        for k, (name, unit, text) in enumerate(errors)
    ]


def controller_interface(model: SeparatedModel | TouchedSegment) -> Interface:
    """Contact force and distance in; tensions that hold the force out.

    Raises:
        ModelError: a model without an obstacle, or with more tensions than the C has room for.
    """
    if not model.has_obstacle:
        raise ModelError("model must have an obstacle for a controller, got a scene without one")
    tensions, distance = model.parameters[:-1], model.parameters[-1]
    if len(tensions) > MOST_TENSIONS:
        raise ModelError(f"model must have at most {MOST_TENSIONS} tensions for a controller, got {len(tensions)}")
    return Interface(
        title=f"{model.scene['name']}: a rubber finger's controller, which holds a contact force",
        unit="fmu_controller.c",
        variables=[
            _held_force(),
            _input(distance, INPUTS + 1),
            *(_start(one, INPUTS + 2 + k) for k, one in enumerate(tensions)),
            *(_output(one["name"], "N", TENSION, OUTPUTS + k) for k, one in enumerate(tensions)),
            _output("residual", "N", f"by how much the force is missed; {UNKNOWN}", RESIDUAL, discrete=True),
            _output("contact_force_error", "N", f"estimated error of the force; {UNKNOWN}", FORCE_ERROR, discrete=True),
            *_flags("converged", "the force is held: status is converged"),
        ],
        statuses=[
            ("converged", 1, "the force is held"),
            ("unreachable", 2, "no tensions hold it: these come nearest"),
            ("iteration_limit", 3, "not solved within the iterations allowed"),
            ("out_of_domain", 4, "beyond what was trained, or an input is no number"),
        ],
    )


def _held_force() -> Variable:
    return Variable(
        name="contact_force",
        reference=INPUTS,
        causality="input",
        description="contact force to hold, above 0",
        unit="N",
        lower=0.0,
        start=HELD,
    )


def _start(tension: dict, reference: int) -> Variable:
    """Of a controller's tension."""
    return Variable(
        name=f"start_{tension['name']}",
        reference=reference,
        causality="parameter",
        description=f"{tension['name']} before the first step: of many answers the nearest is taken",
        unit="N",
        lower=tension["lower"],
        upper=tension["upper"],
        start=tension["lower"],
    )


def _input(parameter: dict, reference: int) -> Variable:
    """Of a model's parameter: tensions start gently, the object far away."""
    is_distance = parameter["unit"] == "m"
    return Variable(
        name=parameter["name"],
        reference=reference,
        causality="input",
        description="distance of the object" if is_distance else "tension of a tendon",
        unit=parameter["unit"],
        lower=parameter["lower"],
        upper=parameter["upper"],
        start=parameter["upper" if is_distance else "lower"],
    )


def _output(name: str, unit: str, description: str, reference: int, discrete: bool = False) -> Variable:
    return Variable(
        name=name, reference=reference, causality="output", description=description, unit=unit, discrete=discrete
    )


def _flags(name: str, description: str) -> list[Variable]:
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
