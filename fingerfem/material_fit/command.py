"""python3 -m fingerfem fit-material."""

from pathlib import Path
from typing import Annotated

import typer

from fingerfem.output.rows import finish
from rom.console.packages import require
from rom.console.program import NOTHING_USABLE


def fit_material(
    data_file: Annotated[
        Path, typer.Argument(metavar="DATA.csv", help="Tests: a header such as test,stretch [-],stress [MPa]; rows.")
    ],
    test: Annotated[
        str | None, typer.Option(help="uniaxial, equibiaxial or planar (pure shear), if the file does not name it.")
    ] = None,
    law: Annotated[
        str | None, typer.Option(help="neo-hookean, mooney-rivlin, yeoh or ogden; all are compared if left out.")
    ] = None,
    terms: Annotated[int, typer.Option(min=1, max=3, help="Of Ogden's law.")] = 2,
    to: Annotated[float | None, typer.Option(help="Fit stretches from 1 / TO to TO alone.")] = None,
    nu: Annotated[float, typer.Option(help="Poisson's ratio, which the tests do not measure: gives D1.")] = 0.499,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="MATERIAL.toml", help="Also write a scene's [material].")
    ] = None,
    plot: Annotated[Path | None, typer.Option(metavar="PLOT.png", help="Also draw tests and laws.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")] = False,
) -> None:
    """Fit a law of the rubber to tests: constants, residuals, stability, and the stretches beyond which it is a guess.

    Strain and stress are nominal (engineering). The law with the least error on points that were left out is chosen.
    """
    require("pydantic", *(() if plot is None else ("matplotlib",)))
    from fingerfem.material_fit.fit import LAWS, compare
    from fingerfem.material_fit.measurements import read_measurements
    from fingerfem.material_fit.report import as_json as whole
    from fingerfem.material_fit.report import material_table, parts
    from rom.files.atomic_file import check_plot, write_whole

    if output is not None and (output.suffix != ".toml" or not output.parent.is_dir()):
        raise ValueError(f"output must end in .toml and be in a folder that exists, got {output}")
    if plot is not None:
        from fingerfem.material_fit.plot import write_plot

        check_plot(plot)
    comparison = compare(read_measurements(data_file, test, to), LAWS if law is None else [law], terms, nu)
    if plot is not None:
        write_plot(comparison, plot)
    if comparison.chosen is not None and output is not None:
        text = material_table(comparison, data_file)
        write_whole(output, lambda stream: stream.write(text.encode()))
    code = NOTHING_USABLE if comparison.chosen is None else 0
    finish(whole(comparison, data_file), as_json, code, parts=parts(comparison, data_file))
