"""How states become what a general method learns: numbers in, numbers out.

Three ways (WAYS), from what a user would do first to what this project does with its own model. Inputs are scaled to
[0, 1], outputs to mean 0 and deviation 1; any Python can import this module.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict
from typing import NamedTuple, Protocol

import numpy as np

from rom.fit.contact_coordinates import ContactCoordinates
from studies.peers.surrogates.states import States

AFAR = 4  # planes that a free state stands for: before touch, nothing depends on d [-]


class Fitted(NamedTuple):
    """What a method has learned.

    Attributes:
        ask: outputs, shape (n, outputs), of inputs, shape (n, inputs).
        size: of what it keeps [B].
        settings: those it has chosen itself.
    """

    ask: Callable[[np.ndarray], np.ndarray]
    size: int
    settings: str


class Method(Protocol):
    """Learns outputs, shape (n, outputs), of inputs, shape (n, inputs); states of one line share a number."""

    def __call__(self, inputs: np.ndarray, outputs: np.ndarray, lines: np.ndarray) -> Fitted:
        """Fit."""


class Learned(NamedTuple):
    """A model of tip and contact force.

    Attributes:
        ask: tip [m] and contact force [N], shape (4,), at tensions and d, shape (p,) [N, m].
        size: [B].
        settings: that its methods have chosen, the contact's first.
        seconds: core-seconds of training.
    """

    ask: Callable[[np.ndarray], np.ndarray]
    size: int
    settings: str
    seconds: float


def one_model(method: Method, states: States) -> Learned:
    """Tip and force of all states over tensions and d; free states stand for planes that they do not touch."""
    begun = time.process_time()
    places, outputs = everywhere(states)
    fitted = learned(method, states.scaled(places), outputs, places[:, :-1])
    seconds = time.process_time() - begun
    return Learned(
        lambda point: pressing(fitted.ask(states.scaled(point)[None])[0]), fitted.size, fitted.settings, seconds
    )


def two_models(method: Method, states: States) -> Learned:
    """A model of the contact states over tensions and d, beside those of the free states, which decide on touch."""
    return _beside_free(method, states, lambda points, reach: states.scaled(points))


def aligned(method: Method, states: States) -> Learned:
    """The same over tensions and this project's s instead of d: touch is at s = 0 for all tensions.

    Free states are contact states, too, then: those of touch, without a force.
    """
    coordinates = ContactCoordinates.over(states.lower[-1], states.upper[-1], states.reach)

    def place(points: np.ndarray, reach: np.ndarray) -> np.ndarray:
        found = coordinates.of(points, reach)
        found[:, :-1] = states.scaled(points[:, :-1])
        return found

    return _beside_free(method, with_touch(states), place)


WAYS: dict[str, Callable[[Method, States], Learned]] = {
    "one model over (F, d)": one_model,
    "free and contact over (F, d)": two_models,
    "free and contact over (F, s)": aligned,
}


def _beside_free(method: Method, states: States, place: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Learned:
    """Touch distance and tip of the free states over tensions; tip and force of the contact states over `place`."""
    begun = time.process_time()
    free = states.scaled(states.tensions)
    reach = learned(method, free, states.touch_distance[:, None], states.tensions)
    still = learned(method, free, states.free_tip, states.tensions)
    places = place(states.parameters, states.reach)
    pressed = learned(method, places, states.pressed, states.parameters[:, :-1])
    seconds = time.process_time() - begun

    def ask(point: np.ndarray) -> np.ndarray:
        tensions = states.scaled(point[:-1])[None]
        touched = reach.ask(tensions)[0]
        if touched[0] <= point[-1]:
            return np.append(still.ask(tensions)[0], 0.0)
        return pressing(pressed.ask(place(point[None], touched))[0])

    size = reach.size + still.size + pressed.size
    return Learned(ask, size, pressed.settings, seconds)


def learned(method: Method, inputs: np.ndarray, outputs: np.ndarray, tensions: np.ndarray) -> Fitted:
    """Fit outputs that are scaled, and scale back what is told; states of the same tensions are of one line."""
    mean, deviation = outputs.mean(axis=0), outputs.std(axis=0)
    deviation = np.where(deviation > 0, deviation, 1.0)  # some outputs of some fingers never move
    lines = np.unique(tensions, axis=0, return_inverse=True)[1].ravel()
    fitted = method(inputs, (outputs - mean) / deviation, lines)
    return fitted._replace(ask=lambda places: fitted.ask(places) * deviation + mean)


def pressing(outputs: np.ndarray) -> np.ndarray:
    """Tip and force, shape (4,), where no force pulls."""
    return np.append(outputs[:3], max(outputs[3], 0.0))


def everywhere(states: States) -> tuple[np.ndarray, np.ndarray]:
    """Parameters, and tip and force, of contact states and of free ones before AFAR planes each."""
    nearest, farthest = states.lower[-1], states.upper[-1]
    begins = np.clip(states.touch_distance, nearest, farthest)
    away = np.linspace(begins, farthest, AFAR, axis=1)
    free = np.column_stack([np.repeat(states.tensions, AFAR, axis=0), away.ravel()])
    still = np.column_stack([np.repeat(states.free_tip, AFAR, axis=0), np.zeros(len(free))])
    return np.concatenate([states.parameters, free]), np.concatenate([states.pressed, still])


def with_touch(states: States) -> States:
    """The same, with the free states that reach the nearest plane among the contact states, where they touch."""
    own = states.touch_distance > states.lower[-1]
    touch = np.column_stack([states.tensions, states.touch_distance])[own]
    more = {"parameters": touch, "reach": touch[:, -1], "tip": states.free_tip[own], "force": np.zeros(len(touch))}
    table = asdict(states)
    return States(**table | {name: np.concatenate([table[name], value]) for name, value in more.items()})
