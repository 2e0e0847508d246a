"""Report of a comparison of fitted laws: tables and lines for people, JSON, and a scene's table of material."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fingerfem.material_fit.fit import WIDEST, WORST, Comparison, Errors, Fit
from fingerfem.material_fit.measurements import Measurement
from fingerfem.scene.laws import Law
from fingerfem.scene.toml_file import UNITS
from rom.console.table import Table, number, percent, shown


def parts(comparison: Comparison, file: Path) -> list[Table | str]:
    """Tests, errors and constants of all laws, and lines that bound what they are good for."""
    shown: list[Table | str] = [f"{file}: {described(one)}" for one in comparison.measurements]
    header = ["law", "mu [kPa]", "E [kPa]", "residual", "largest", "left out", "stable at stretches"]
    title = "Residual (root mean square), largest, and on points left out of the fit: of each test's peak stress"
    rows = [_row(one, one is comparison.chosen) for one in comparison.fits]
    shown.append(Table(title=title, header=header, rows=rows))
    shown += [f"{one.name}: {constants(one.law)}" for one in comparison.fits if one.law is not None]
    return [*shown, *lines(comparison)]


def described(measurement: Measurement) -> str:
    """A test in few words."""
    stretch, peak = measurement.stretch, number(measurement.peak, "Pa")
    return f"{measurement.mode}, {len(stretch)} points, stretch {stretch[0]:.4g} to {stretch[-1]:.4g}, peak {peak} kPa"


def _row(fit: Fit, is_chosen: bool) -> list[str]:
    """A law's row in the table of errors."""
    if fit.law is None or fit.errors is None or fit.left_out is None:
        return [fit.name, *5 * ["-"], "refused"]
    own = (fit.errors.rms, fit.errors.largest, fit.left_out.rms)
    moduli = [number(modulus, "Pa") for modulus in (fit.law.shear_modulus, fit.law.young_modulus)]
    return [f"{fit.name}{' (chosen)' if is_chosen else ''}", *moduli, *map(percent, own), stability(fit)]


def stability(fit: Fit) -> str:
    """Range of stretches in which a law is stable, in words."""
    if fit.law is not None and fit.law.is_always_stable:
        return "all"
    if fit.loss is None:
        return f"{WIDEST[0]:g} to {WIDEST[1]:g}"
    return f"lost at {fit.loss[1]:.3g}, {fit.loss[0]}"


def constants(law: Law) -> str:
    """A law's constants in the units that people read."""
    words = []
    for name, value in law:
        if name in Law.model_fields:  # a key of every law is no constant
            continue
        unit = UNITS.get(name, "")
        each = value if isinstance(value, list) else [value]
        factor = shown(unit)[0]
        text = ", ".join(f"{factor * one:.5g}" for one in each)
        words.append(f"{name} = {f'[{text}]' if isinstance(value, list) else text} {shown(unit)[1]}".rstrip())
    return "; ".join(words)


def lines(comparison: Comparison) -> list[str]:
    """Lines with the limits of the fits."""
    low, high = comparison.stretches
    limits = [f"{one.name} is refused: {one.reason}" for one in comparison.fits if one.law is None]
    limits += [
        f"{one.name}: the best constants are not stable within the data; these are the best of the stable ones"
        for one in comparison.fits
        if one.is_constrained
    ]
    limits.append(f"no data are below a principal stretch of {low:.4g} or above {high:.4g}: a law is a guess there")
    modes = [one.mode for one in comparison.measurements]
    if len(modes) == 1:
        limits.append(f"all data are {modes[0]}: to other loads, such as shear, a law only extrapolates")
    limits += comparison.doubts
    if comparison.chosen is not None and comparison.chosen.law is not None:
        limits.append(f"D1 follows from nu = {comparison.chosen.law.poisson:.6g}, which these tests do not measure")
    else:
        left_out = [one.left_out.rms for one in comparison.fits if one.left_out is not None]
        poor = f": the errors of all exceed {percent(WORST)} of the peak stress" if left_out else ""
        limits.append(f"no law is usable{poor}")
    return limits


def as_json(comparison: Comparison, file: Path) -> dict[str, Any]:
    """All of it; SI units, errors relative to each test's peak."""
    chosen = comparison.chosen
    return {
        "file": str(file),
        "tests": [
            {
                "test": one.mode,
                "points": len(one.stretch),
                "stretch": [float(one.stretch[0]), float(one.stretch[-1])],
                "peak_stress": one.peak,
            }
            for one in comparison.measurements
        ],
        "stretches": list(comparison.stretches),
        "chosen": chosen.name if chosen else None,
        "material": chosen.law.model_dump(exclude_none=True) if chosen and chosen.law else None,
        "laws": [_law_as_json(one) for one in comparison.fits],
        "doubts": list(comparison.doubts),
    }


def _law_as_json(fit: Fit) -> dict[str, Any]:
    """One law."""

    def errors(of: Errors | None) -> dict[str, Any] | None:
        if of is None:
            return None
        tests = {mode: {"rms": rms, "largest": largest} for mode, (rms, largest) in of.by_mode.items()}
        return {"rms": of.rms, "largest": of.largest, "tests": tests}

    law = fit.law
    return {
        "law": fit.name,
        "usable": law is not None,
        "reason": fit.reason,
        "material": law.model_dump(exclude_none=True) if law else None,
        "shear_modulus": law.shear_modulus if law else None,
        "young_modulus": law.young_modulus if law else None,
        "constrained": fit.is_constrained,
        "residual": errors(fit.errors),
        "left_out": errors(fit.left_out),
        "stability_lost": {"mode": fit.loss[0], "stretch": fit.loss[1]} if fit.loss else None,
    }


def material_table(comparison: Comparison, file: Path) -> str:
    """The chosen law as a scene's `[material]`, with what it was fitted to.

    Raises:
        ValueError: no law is usable.
    """
    fit = comparison.chosen
    if fit is None or fit.law is None or fit.errors is None or fit.left_out is None:
        raise ValueError("comparison must have a usable law, got none")
    name = "".join(one if one.isprintable() else "?" for one in file.name)
    tests = [described(one) for one in comparison.measurements]
    residual = f"{percent(fit.errors.rms)} of the peak stress, {percent(fit.left_out.rms)} on points left out"
    head = [f"Fitted by python3 -m fingerfem fit-material to {name}:", *tests, f"residual (rms): {residual}"]
    head += comparison.doubts
    rows = [
        f"{key} = {_value(value)}{_comment(key, fit.law)}"
        for key, value in fit.law.model_dump(exclude_none=True).items()
    ]
    return "\n".join([*(f"# {line}" for line in head), "[material]", *rows]) + "\n"


def _value(value: str | float | Sequence[float]) -> str:
    """A value in TOML."""
    if isinstance(value, str):
        return f'"{value}"'
    return str(value) if isinstance(value, float) else f"[{', '.join(map(str, value))}]"


def _comment(key: str, law: Law) -> str:
    """The unit of a key, and what it is."""
    if key == "stretches":
        return "  # [-], lowest and highest principal stretch of the data"
    source = f", from nu = {law.poisson:.6g}" if key == "D1" else ""
    return f"  # [{UNITS[key]}]{source}" if key in UNITS else ""
