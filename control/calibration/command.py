"""python3 -m control calibrate."""

from pathlib import Path
from typing import Annotated

import typer

from rom.console.command_line import NOTHING_USABLE, AsJson
from rom.console.packages import require
from rom.console.table import show
from rom.files.atomic_file import check_folder, check_plot


def calibrate(
    model: Annotated[Path, typer.Argument(metavar="FINGER.h5")],
    log: Annotated[
        Path, typer.Argument(metavar="LOG.csv", help="A header such as F1 [N],F2 [N],x [mm],y [mm],z [mm]; rows.")
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="MINE.h5", help="Also write the calibrated finger.")
    ] = None,
    fit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="modulus, size, base, density, friction or pulley_radius; repeat. Default: modulus, base.",
        ),
    ] = None,
    noise: Annotated[
        list[str] | None,
        typer.Option(
            help="Known standard deviation, such as position=0.5mm or tension=2%; repeat. Others are estimated."
        ),
    ] = None,
    pulley_radius: Annotated[float | None, typer.Option(help="Of the motors [m], for torques and angles.")] = None,
    gravity: Annotated[
        tuple[float, float, float] | None,
        typer.Option(help="Direction of the weight in the clamp's frame, for density."),
    ] = None,
    ignore: Annotated[list[str] | None, typer.Option(metavar="COLUMN", help="Do not read it; repeat.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="PLOT.png", help="Also draw the residuals.")] = None,
    as_json: AsJson = False,
) -> None:
    """Fit a finger's parameters to a log: values, intervals, and what the log does not determine."""
    if output is not None:
        check_folder(output)
    if plot is not None:
        require("matplotlib")
        from control.calibration.plot import write_plot

        check_plot(plot)
    from control.calibration.calibrate import CalibrationOptions, noise_of
    from control.calibration.calibrate import calibrate as run
    from control.calibration.fit import NotFitted

    options = CalibrationOptions(
        fit=fit or (),
        noise=dict(map(noise_of, noise or ())),
        pulley_radius=pulley_radius,
        gravity=gravity,
        ignored=ignore or (),
    )
    try:
        result = run(model, log, options)
    except NotFitted as error:
        show({"status": "not converged", "reason": str(error)}, [str(error)], as_json, NOTHING_USABLE)
    determined = any(one.determined for one in result.parameters)
    if plot is not None:
        write_plot(result, plot)
    if output is not None and determined:
        result.rod.save(output)
    show(result.as_json(), result.tables(), as_json, 0 if determined else NOTHING_USABLE)
