"""Errors of prediction, leave-one-out: every pose by its motors' readings and the parameters that the others give."""

from dataclasses import replace

import numpy as np

from control.calibration.fit import Fit, settle
from control.calibration.measured import MOTORS, Measured


def errors_left_out(measured: Measured, fit: Fit) -> dict[str, np.ndarray]:
    """Every group that no motor shows: sizes of the errors of all poses, shape (n,), nan where nothing was measured.

    The parameters without pose i follow from the normal equations without it, one step of Gauss-Newton. With friction,
    whose poses are a history, the prediction is linear in these parameters.
    """
    motor = next((name for name in MOTORS if name in measured.groups), None)
    if motor is None:
        return {}
    predicted, inverse = np.zeros_like(fit.residuals), fit.covariance
    history = measured.residuals(fit.unknowns, _read(measured, fit, motor)) if measured.finger.guides else None
    for i in range(len(fit.tensions)):
        alone = replace(measured, log=measured.log.only(np.array([i])), excluded={})
        read = replace(alone, excluded={name: np.ones(1, bool) for name in measured.groups if name != motor})
        own = fit.projected[i]
        gain = np.eye(len(own)) - own @ inverse @ own.T
        moved = fit.unknowns + inverse @ own.T @ np.linalg.lstsq(gain, fit.residuals[i], rcond=1e-9)[0]
        if history is not None:
            predicted[i] = history.values[i] + history.by_unknown[i] @ (moved - fit.unknowns)
            continue
        tensions = settle(read, fit.noise, moved, fit.tensions[i : i + 1])
        predicted[i] = alone.residuals(moved, tensions).values[0]
    return {name: sizes(measured, name, predicted) for name in measured.groups if name != motor}


def _read(measured: Measured, fit: Fit, motor: str) -> np.ndarray:
    """Tensions by the motors' readings alone, shape (n, t) [N]; the fitted ones where motors show no tension."""
    radius = measured.unknowns.values(fit.unknowns)["pulley_radius"]
    readings = {"tension": measured.log.tension, "torque": measured.log.torque / radius}.get(motor, fit.tensions)
    return np.clip(np.where(np.isfinite(readings), readings, fit.tensions), *measured.ends(fit.unknowns))


def sizes(measured: Measured, group: str, residuals: np.ndarray) -> np.ndarray:
    """Sizes of the residuals of a group, shape (n,): of vectors their length, of tendons the largest; nan if unused."""
    own = np.array(measured.columns) == group
    used = measured.used[:, own] & np.isfinite(measured.readings[:, own])
    values = np.abs(residuals[:, own])
    lengths = np.linalg.norm(values, axis=1) if group in ("position", "orientation") else values.max(axis=1)
    return np.where(used.any(axis=1), lengths, np.nan)
