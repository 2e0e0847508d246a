"""The degrees of the elements' polynomials, chosen by the error of the assembled finger in left-out lines."""

from collections.abc import Callable

from rom.elements.fitting.candidates import STEP, Candidates

LOWEST = 2.0  # weighted degree that is tried [-]
HIGHEST = 5.0  # unless a user asks for more: 6 halves the errors of long fingers, with twice the products [-]
BETTER = 0.97  # more terms are accepted if the error falls below this factor times the best so far [-]


def best_degrees(score: Callable[[dict[str, float]], float], kinds: dict[str, Candidates]) -> dict[str, float]:
    """The degrees with the smallest error: one for all kinds first, then each kind's higher or lower.

    A kind's degree grows as long as that makes the error smaller, and falls as long as that costs next to nothing.

    Args:
        score: error of the finger with these degrees, by kind [-].
        kinds: candidates of every kind of element.
    """
    highest = {kind: _highest(one) for kind, one in kinds.items()}
    steps = int((max(highest.values()) - LOWEST) / STEP) + 1
    shared = [{kind: min(LOWEST + STEP * k, top) for kind, top in highest.items()} for k in range(steps)]
    scores = [score(degrees) for degrees in shared]
    best = min(scores)
    degrees = shared[scores.index(best)]
    for kind, top in highest.items():
        while degrees[kind] < top and (error := score(_changed(degrees, kind, STEP))) < BETTER * best:
            best, degrees = error, _changed(degrees, kind, STEP)
    for kind in highest:
        while degrees[kind] > LOWEST and score(_changed(degrees, kind, -STEP)) < best / BETTER:
            degrees = _changed(degrees, kind, -STEP)
    return degrees


def _changed(degrees: dict[str, float], kind: str, step: float) -> dict[str, float]:
    return degrees | {kind: degrees[kind] + step}


def _highest(one: Candidates) -> float:
    """The highest degree that a kind's samples support."""
    degree = LOWEST
    while one.supports(degree + STEP):
        degree += STEP
    return degree
