"""Part `surrogates`: other packages' surrogates beside this project's, trained on the same states.

Measured in a virtual environment that has these packages (studies.peers.others), on what training_states.py wrote.
"""

from __future__ import annotations

from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from rom.surrogate import Surrogate
from studies.peers.question import CONTACT, FREE, Answers
from studies.peers.surrogates.grid_form import decomposed
from studies.peers.surrogates.judging import best_of, errors, query_times
from studies.peers.surrogates.learning import WAYS, Learned
from studies.peers.surrogates.regressors import METHODS
from studies.peers.surrogates.states import LINES, QUICK_LINES, HeldOut, States
from studies.runner import Run, read

ASIDE = 0.0  # tension of F2, which all of them also know [N]
OWN_PACKAGE, OWN_METHOD, OWN_WAY = "fingerfem", "separated forms", "free and regimes over (F, s)"
NO_MORE = "no sensitivities, no estimate of a query's error, no mark outside what it was trained for"
LIMITS = {
    "POD, RBF": NO_MORE,
    "POD, GPR": "no sensitivities; its variance, not asked for here, grows outside what it was trained for",
    "Gaussian process": "no sensitivities; its deviation, not asked for here, grows outside what it was trained for",
    "neural network": f"{NO_MORE}; other first weights make another model",
    "CP regression": NO_MORE,
    OWN_METHOD: "within the tensions and distances it was trained for, and says where it is not",
}


def ours(folder: Path, lines: int, seconds: float) -> Learned:
    """This project's model, asked for all that it says: also touch distance, estimated errors, whether it is inside."""
    model = Surrogate.load(folder / f"ours-{lines}.h5")
    size = replace(model, displacements=None).bytes
    regimes = f"{len(model.regimes)} contact regimes"

    def ask(point: np.ndarray) -> np.ndarray:
        told = model.evaluate(point)
        return np.append(told.tip, told.contact_force)

    return Learned(ask, size, regimes, seconds)


def question(states: States) -> np.ndarray:
    """Its points: free states before the farthest plane, then those in contact, shape (14, 3) [N, m]."""
    free = [(tension, ASIDE, float(states.upper[-1])) for tension in FREE]
    return np.array(free + [(tension, ASIDE, distance) for tension, distance in CONTACT])


def judged(learned: Learned, tested: HeldOut) -> dict[str, Any]:
    """Errors on held-out states, asked one by one as a controller does, times of queries, and size."""
    told = np.array([learned.ask(point) for point in tested.parameters])
    return errors(told, tested) | {
        "query": query_times(learned.ask, tested.parameters),
        "bytes": learned.size,
        "training_seconds": learned.seconds,
        "settings": learned.settings,
    }


def row(learned: Learned, states: States, tested: HeldOut) -> dict[str, Any]:
    """The same, with what it tells of the question."""
    told = [learned.ask(point).tolist() for point in question(states)]
    return judged(learned, tested) | {"states": states.count, "question": told}


def grid_row(file: Path, states: int) -> dict[str, Any]:
    """TensorLy's CP of a grid, on states of its own: asked in the grid's coordinates, and of contact alone."""
    found = judged(*decomposed(file)) | {"states": states}
    found.pop("touch")
    return {"package": "TensorLy", "method": "CP of a grid"} | found


def answers(best: dict[str, Any], curve: list[dict[str, Any]]) -> Answers:
    """What a row tells of the question; `curve` has the same model of fewer states, too."""
    free, touching = best["question"][: len(FREE)], best["question"][len(FREE) :]
    refinement = [{key: one[key] for key in ("states", "contact_force", "tip")} for one in curve]
    return Answers(
        name=f"{best['package']}, {best['method']}",
        kind="surrogate",
        free_tips=[told[:3] for told in free],
        contact_tips=[told[:3] for told in touching],
        contact_forces=[told[3] for told in touching],
        seconds=best["query"]["seconds"],
        settings="; ".join([_released(best["package"]), best["way"], best["settings"], f"{best['states']} states"]),
        refinement=refinement,
        limits=f"{LIMITS[best['method']]}; quasi-static",
    )


def _released(package: str) -> str:
    """With its version; this project's is the page's."""
    return package if package == OWN_PACKAGE else f"{package} {version(package.lower())}"


def rows_of(run: Run, lines: int, tested: HeldOut, seconds: float) -> list[dict[str, Any]]:
    """Every method, in every way, of the states of some lines; `seconds` is what this project's training took."""
    states = States.load(run.folder / f"states-{lines}.npz")

    def measured(package: str, method: str, way: str, learn: Any) -> dict[str, Any]:
        found = run.once(f"{package}, {method}, {way}, {lines}", lambda: row(learn(), states, tested))
        return {"package": package, "method": method, "way": way, "lines": lines} | found

    own = measured(OWN_PACKAGE, OWN_METHOD, OWN_WAY, lambda: ours(run.folder, lines, seconds))
    others = [
        measured(package, name, way, lambda learn=learn, method=method: learn(method, states))
        for (package, name), method in METHODS.items()
        for way, learn in WAYS.items()
    ]
    return [own, *others]


def measure(run: Run) -> dict[str, Any]:
    """Every method, in every way.

    Returns:
        `rows` of all states; `curves`, the same of fewer, too; `grid`, the row of a method that needs states of its
        own; and `answers` of every method in its best way.
    """
    given = read("peers/training_states", run.folder.parents[1], run.quick)
    if given is None:
        raise SystemExit("peers/training_states must be measured first: python3 -m studies.runner peers")
    seconds = {one["lines"]: one["training_seconds"] for one in given["result"]["rows"]}
    tested, counts = HeldOut.load(run.folder / "tested.npz"), QUICK_LINES if run.quick else LINES
    curves = [one for lines in counts for one in rows_of(run, lines, tested, seconds[lines])]
    rows = [one for one in curves if one["lines"] == counts[-1]]
    told = []
    for method in dict.fromkeys(one["method"] for one in rows):
        best = best_of([one for one in rows if one["method"] == method])
        curve = [one for one in curves if (one["method"], one["way"]) == (method, best["way"])]
        told.append(answers(best, curve).as_json())
    for one in curves:
        one.pop("question")
    grid = run.once("grid", grid_row, run.folder / "grid.npz", given["result"]["grid_states"])
    return {"rows": rows, "curves": curves, "grid": grid, "answers": told}
