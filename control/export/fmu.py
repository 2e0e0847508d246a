"""The FMU of a controller: contact force and distance in, tensions and pressures that hold the force out."""

from pathlib import Path

from control.export import NATIVE, UNITS
from rom.export.fmu import archive
from rom.export.fmu.variables import INPUTS, OUTPUTS, UNKNOWN, Interface, Variable, flags_of, input_of, output_of
from rom.files.checked_file import ModelError
from rom.parameter import Parameter
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel

RESIDUAL, FORCE_ERROR = OUTPUTS + 8, OUTPUTS + 9  # value references, as in native/fmu_controller.c
MOST_TENSIONS = 8  # likewise
HELD = 1.0  # [N]: the contact force that a controller begins with
HOLDS = {
    unit: f"{load} that holds, or comes nearest; out_of_domain keeps the last step's"
    for unit, load in (("N", "tension"), ("Pa", "pressure"))
}


def write(model: SeparatedModel | TouchedSegment, path: Path, version: int = 3) -> None:
    """Write the FMU of the controller that holds a contact force with a model.

    Args:
        model: it must have an obstacle.
        path: a file named .fmu; its stem is the model's identifier.
        version: of FMI, 2 or 3.

    Raises:
        ModelError: no such version, no C identifier, a model that this is not possible for, or no compiler.
    """
    archive.write(model, path, version, interface(model))


def interface(model: SeparatedModel | TouchedSegment) -> Interface:
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
        units=[NATIVE / "fmu_controller.c", *UNITS],
        variables=[
            _held_force(),
            input_of(distance, INPUTS + 1),
            *(_start(one, INPUTS + 2 + k) for k, one in enumerate(tensions)),
            *(output_of(one.name, one.unit, HOLDS[one.unit], OUTPUTS + k) for k, one in enumerate(tensions)),
            output_of("residual", "N", f"by how much the force is missed; {UNKNOWN}", RESIDUAL, discrete=True),
            output_of("contact_force_error", "N", f"its estimated error; {UNKNOWN}", FORCE_ERROR, discrete=True),
            *flags_of("converged", "the force is held: status is converged"),
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


def _start(tension: Parameter, reference: int) -> Variable:
    """Start value of a controller's tension or pressure."""
    return Variable(
        name=f"start_{tension.name}",
        reference=reference,
        causality="parameter",
        description=f"{tension.name} before the first step: of many answers the nearest is taken",
        unit=tension.unit,
        lower=tension.lower,
        upper=tension.upper,
        start=tension.lower,
    )
