"""Logs that cannot be fitted are refused in one line that names column and row."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from control.calibration.fit import Fit, first_tensions, fit
from control.calibration.measured import GROUPS, MOTORS, Measured
from control.log import Log
from rom.files.csv_table import Refused

FAR = 3.0  # largest reading over the largest trained tension, and least movement over that of the model [-]
BELOW = 0.05  # how far below zero a tension may be, over the largest trained one [-]
SAME = 1e-9  # relative difference of readings that are equal [-]
BAD, BETTER = 0.1, 4.0  # residual over the movement of the tip, and its ratio to that with two columns exchanged [-]
MOST_TENDONS = 4  # pairs of more are not exchanged


def check(measured: Measured) -> None:
    """Refuse a log that cannot be fitted.

    Raises:
        Refused: one line with file, line, column, rule and value.
    """
    log = measured.log
    motor = next((name for name in MOTORS if log.has(name)), None)
    if motor is None:
        wanted = ", ".join(f"{name} [N]" for name in log.tendons)
        raise Refused(f"{log.path}: must have what the motors did, such as {wanted}, got no such column")
    if len(measured.groups) == 1:
        raise Refused(f"{log.path}: must have a position, orientation or contact force, got {motor} alone")
    if log.has("contact force") and not log.has("d"):
        raise Refused(f"{log.path}: contact force must come with d, the distance of the object, got no column d")
    _check_motors(measured, motor)
    _check_movement(measured)


def _check_motors(measured: Measured, motor: str) -> None:
    """Every pose has readings of its motors, which differ and lie in the trained domain."""
    log, readings = measured.log, getattr(measured.log, motor)
    known = np.any([np.isfinite(getattr(log, name)) for name in MOTORS], axis=0)
    for row, k in np.argwhere(~known)[:1]:
        quantity = f"{motor} {log.tendons[k]}"
        raise Refused(f"{log.where(row, quantity)}: must have a number in every line, got an empty cell")
    first = np.nan_to_num(readings[0])
    if len(readings) == 1:
        raise Refused(f"{log.path}: must have poses that differ, got one pose (line {log.lines[0]})")
    if (np.abs(np.nan_to_num(readings) - first) <= SAME * np.abs(first)).all() and len(
        np.unique(measured.distances)
    ) == 1:
        texts = ", ".join(f"{log.headings[f'{motor} {name}'].text}" for name in log.tendons)
        ends = f"lines {log.lines[0]} to {log.lines[-1]}"
        raise Refused(f"{log.path}: {texts} must not be constant, got the same in {ends}")
    lower, upper = measured.ends(np.zeros(len(measured.unknowns.names)))
    factor = {"tension": 1.0, "torque": measured.unknowns.starts["pulley_radius"]}.get(motor)
    if factor is None:
        return
    free = any(name in measured.unknowns.names for name in ("modulus", "size"))
    highest = factor * (FAR if free else 1.0) * upper
    lowest = factor * (lower - BELOW * upper)
    for row, k in np.argwhere((readings < lowest) | (readings > highest))[:1]:
        quantity = f"{motor} {log.tendons[k]}"
        heading = log.headings[quantity]
        scale = {"tension": "N", "torque": "N m"}[motor]
        raise Refused(
            f"{log.where(row, quantity)}: must lie in {lowest[k]:.3g} to {highest[k]:.3g} {scale}, "
            f"where the finger was trained, got {readings[row, k]:.4g} {scale}; is [{heading.unit}] its unit?"
        )


def _check_movement(measured: Measured) -> None:
    """The measurements change about as much as the model's outputs: otherwise a unit is wrong."""
    none = np.zeros(len(measured.unknowns.names))
    sigma = {name: GROUPS[name][1] for name in measured.groups}
    tensions = first_tensions(measured, none, sigma)
    model = measured.residuals(none, tensions).values + np.nan_to_num(measured.readings)
    for group, names in _columns(measured):
        own = np.array(measured.columns) == group
        used = measured.used[:, own].all(axis=1)
        if group == "orientation" or used.sum() < 2:
            continue
        seen, expected = (one[used][:, own] - one[used][:, own].mean(axis=0) for one in (measured.readings, model))
        moved, expects = float(np.linalg.norm(seen)), float(np.linalg.norm(expected))
        ratio = moved / (expects or 1.0)
        if 1 / (FAR * FAR) < ratio < FAR * FAR or expects == 0:
            continue
        row, k = divmod(int(np.abs(seen).argmax()), seen.shape[1])
        where = measured.log.where(int(np.flatnonzero(used)[row]), names[k])
        changes = f"{group.replace('_', ' ')} must change about as much as that of the finger, got {ratio:.2g} times"
        raise Refused(f"{where}: {changes} as much; is [{measured.log.headings[names[k]].unit}] its unit?")


def _columns(measured: Measured) -> Iterator[tuple[str, list[str]]]:
    """Groups, and the headings' names of their columns."""
    for group in measured.groups:
        if group == "position":
            yield group, list("xyz")
        elif group == "contact_force":
            yield group, ["contact force"]
        elif group != "orientation":
            yield group, [f"{group} {name}" for name in measured.log.tendons]


def check_order(measured: Measured, found: Fit) -> None:
    """Refuse a log whose residuals are far less if two of its columns are exchanged.

    Raises:
        Refused: names both columns, and the line with the largest residual.
    """
    own = (np.array(measured.columns) == "position") & np.isfinite(measured.readings).any(axis=0)
    if not own.any():
        return
    plain = found.residuals[:, own] / np.where(measured.used[:, own], found.whitening[:, own], 1.0)
    movement = np.nanstd(measured.readings[:, own], axis=0)
    bad = float(np.sqrt((plain**2).mean()))
    if bad < BAD * np.linalg.norm(movement):
        return
    row = int(np.linalg.norm(plain, axis=1).argmax())
    for first, second, log in _exchanged(measured.log):
        other = fit(replace(measured, log=log), {}, None)
        better = other.residuals[:, own] / np.where(measured.used[:, own], other.whitening[:, own], 1.0)
        if float(np.sqrt((better**2).mean())) * BETTER < bad:
            texts = " and ".join(measured.log.headings[name].text for name in (first, second))
            raise Refused(
                f"{measured.log.where(row)}: {texts} must be what the first line says, got a residual of "
                f"{1e3 * bad:.2g} mm, which is less than {1e3 * bad / BETTER:.2g} mm if they are exchanged"
            )


def _exchanged(log: Log) -> Iterator[tuple[str, str, Log]]:
    """Names of two columns, and the log with their numbers exchanged."""
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if all("xyz"[k] in log.headings for k in (i, j)):
            yield "xyz"[i], "xyz"[j], log.having(position=_with_exchanged(log.position, i, j))
    for name in MOTORS:
        for j in range(1, min(len(log.tendons), MOST_TENDONS) if log.has(name) else 0):
            for i in range(j):
                columns = [f"{name} {log.tendons[k]}" for k in (i, j)]
                yield columns[0], columns[1], log.having(**{name: _with_exchanged(getattr(log, name), i, j)})


def _with_exchanged(values: np.ndarray, i: int, j: int) -> np.ndarray:
    """A copy with two columns exchanged."""
    exchanged = values.copy()
    exchanged[:, [i, j]] = values[:, [j, i]]
    return exchanged
