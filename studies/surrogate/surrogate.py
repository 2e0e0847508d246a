"""The surrogate, measured: error on fresh states, regimes beside plain separation, speed, and other packages beside it.

python3 studies/surrogate/surrogate.py [OUT] [--quick]
    prints tables, writes OUT/surrogate.json (out/surrogate by default)

It also writes OUT/others.npz, the states that studies/surrogate/others.py gives to other packages.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from rom.build import train
from rom.error_model import calibrated
from rom.fit import chebyshev
from rom.fit.contact_response import ContactResponse, count_regimes
from rom.fit.free_response import FreeResponse
from rom.held_out import FELT, check
from rom.native import answer
from rom.native.forms import values_and_gradients
from rom.separation.alternating_directions import EnrichmentOptions
from rom.separation.separate import separated
from rom.separation.separated_form import Separated
from rom.snapshots.snapshot_set import SnapshotSet
from rom.snapshots.training_states import read_training_states
from rom.surrogate import Surrogate
from studies import sets
from studies.solver.solver import say

JUDGED = ("draft", "middle", "two segments")
OPTIONS = EnrichmentOptions()


def accuracy(training: SnapshotSet, fresh: SnapshotSet, scaling: SnapshotSet) -> tuple[Surrogate, dict]:
    """Error of a model on fresh states, and how what it says of its error compares."""
    begun = time.perf_counter()
    model = train(training, OPTIONS)
    seconds = time.perf_counter() - begun
    model = calibrated(model, scaling)
    found = check(model, fresh)
    touching = training.states_of("contact", "contact_force") > 0
    return model, found | {
        "training_states": training.states,
        "contact_states": int(touching.sum()),
        "regimes": [{"code": list(regime.code), "states": regime.states} for regime in model.regimes],
        "separation_seconds": seconds,
        "said": honesty(model, fresh),
    }


def honesty(model: Surrogate, fresh: SnapshotSet) -> dict:
    """Share of true errors within what is said, and what is said (median) over what 95 % keep, for the halves that say
    least and most.
    """
    points, force = fresh.random("parameters"), fresh.random("contact_force")
    answer = model.evaluate(points)
    true = {
        "tip": np.linalg.norm(answer.tip - fresh.random("tip"), axis=1),
        "contact_force": np.abs(answer.contact_force - force),
        "touch_distance": np.abs(answer.touch_distance - fresh.random("touch_distance")),
    }
    if model.has_field:
        field = fresh.random("displacement")
        moved = np.array([model.displacement(point) for point in points])
        true["displacement"] = np.sqrt(np.mean(np.sum((moved - field) ** 2, axis=2), axis=1))
    found = {}
    for name, errors in true.items():
        said, errors = answer.error[name][force > 0], errors[force > 0]
        halves = np.array_split(np.argsort(said), 2)
        found[name] = {
            "covered": float(np.mean(errors <= said)),
            "ratios": [float(np.median(said[half]) / np.percentile(errors[half], 95)) for half in halves],
        }
    return found


def plain(training: SnapshotSet, fresh: SnapshotSet) -> list[dict]:
    """The same states without regimes: one form over (F, d), and one over (F, s) for all contact states together."""
    table = read_training_states(training)
    free = FreeResponse.of(table)
    contact = ContactResponse.of(table, free, count_regimes([table]))
    lower, upper = table.lower, table.upper
    points, force = fresh.random("parameters"), fresh.random("contact_force")
    felt = force > FELT
    rows = []

    def fitted(places, states, slopes, ends):
        samples = chebyshev.Samples(
            points=places,
            values=states[:, None],
            slopes=slopes[:, None],
            weights=0.02 / (states / states.max() + 0.02),
            lower=ends[0],
            upper=ends[1],
        )
        return separated("force", chebyshev.fit(samples).polynomial, places, OPTIONS)

    def error(name: str, form: Separated, at: np.ndarray) -> None:
        said = np.maximum([form.value(place)[0] for place in at], 0.0)
        off = np.abs(said - force)[felt] / force[felt]
        rows.append({"form": name, "terms": form.terms} | quantiles(off))

    slopes = table.contact["contact_force_jacobian"][contact.kept]
    # Before touch nothing depends on d: free states stand for planes anywhere beyond their reach.
    tensions, reach = free.points, table.free["touch_distance"]
    away = [np.linspace(max(one, lower[-1]), upper[-1], 6)[1:] for one in reach]
    beyond = np.column_stack([np.repeat(tensions, 5, axis=0), np.concatenate(away)])
    places = np.concatenate([contact.parameters, beyond])
    states = np.concatenate([contact.force, np.zeros(len(beyond))])
    turned = np.concatenate([slopes, np.zeros((len(beyond), slopes.shape[1]))])
    error("one form over (F, d)", fitted(places, states, turned, (lower, upper)), points)

    known, rising = free.polynomial.value_and_gradient(contact.parameters[:, :-1])
    leads = known[:, 3:].argmax(axis=1)
    height = known[np.arange(len(known)), 3 + leads]
    aligned = contact.coordinates.of(contact.parameters, height)
    rises = rising[np.arange(len(known)), 3 + leads]
    by = contact.coordinates.slopes(contact.parameters, height, rises, slopes[:, None])[:, 0]
    ends = np.append(lower[:-1], 0.0), np.append(upper[:-1], aligned[:, -1].max())
    now = free.polynomial.value(points[:, :-1])[:, 3:].max(axis=1)
    at = contact.coordinates.of(points, now)
    form = fitted(aligned, contact.force, by, ends)
    touches = now > points[:, -1]
    error("one form over (F, s)", form, np.where(touches[:, None], at, np.append(lower[:-1], 0.0)))
    return rows


def quantiles(errors: np.ndarray) -> dict:
    """Median, 95 % and largest."""
    return {
        "median": float(np.median(errors)),
        "p95": float(np.percentile(errors, 95)),
        "max": float(errors.max()),
    }


def timed(call, points: np.ndarray) -> dict:
    """Median and 99th percentile of a call at every point [us]."""
    call(points[0])
    taken = np.empty(len(points))
    for k, point in enumerate(points):
        begun = time.perf_counter_ns()
        call(point)
        taken[k] = time.perf_counter_ns() - begun
    return {"p50_us": float(np.percentile(taken, 50)) / 1e3, "p99_us": float(np.percentile(taken, 99)) / 1e3}


def draw(model: Surrogate, count: int) -> np.ndarray:
    """Points of the box."""
    lower, upper = model.limits
    return lower + np.random.default_rng(0).random((count, len(lower))) * (upper - lower)


def speed(model: Surrogate, file: Path, count: int) -> dict:
    """One core, from Python."""
    model.save(file)
    Surrogate.load(file)
    begun = time.perf_counter()
    model = Surrogate.load(file)
    loading = time.perf_counter() - begun
    points = draw(model, 20_000)
    single = timed(model.value_and_jacobian, points)
    many = draw(model, count)
    model.evaluate(many[:10])
    begun = time.perf_counter()
    answer.answers(model.kernel, many)
    batch = (time.perf_counter() - begun) / count
    return {
        "load_seconds": loading,
        "value_and_jacobian": single,
        "batch": {"count": count, "us_each": 1e6 * batch},
        "bytes": file.stat().st_size,
        "terms": model.terms,
    }


def field(folder: Path, draft: SnapshotSet, count: int) -> dict:
    """Time of the whole displacement field on the paper's mesh, of a model of few states that correct the draft's."""
    model = train(sets.training(sets.scene(folder, "paper")), OPTIONS, draft)
    file = folder / "paper.h5"
    model.save(file)
    Surrogate.load(file)
    begun = time.perf_counter()
    model = Surrogate.load(file)
    loading = time.perf_counter() - begun
    assert model.displacements is not None and model.displacements.contact_basis is not None
    points = draw(model, count)
    touching = points[model.evaluate(points).contact_force > 0]
    return {
        "unknowns": 3 * len(model.nodes),
        "components": model.displacements.free_basis.shape[1] + model.displacements.contact_basis.shape[1],
        "in_contact": timed(model.displacement, touching),
        "load_seconds": loading,
        "bytes": file.stat().st_size,
    }


def cost() -> dict:
    """Time of one form's value and gradient in compiled code, against terms and axes, everything else alike."""

    def form(axes: int, terms: int) -> Separated:
        random = np.random.default_rng(0)
        return Separated(
            lower=np.zeros(axes),
            upper=np.ones(axes),
            factors=[random.random((21, terms)) for _ in range(axes)],
            slopes=[random.random((21, terms)) for _ in range(axes)],
            modes=random.random((4, terms)),
            errors=np.zeros(terms),
            lost=np.zeros((terms, 4)),
        )

    def each(one: Separated) -> float:
        points, taken = np.random.default_rng(1).random((3000, len(one.lower))), []
        for _ in range(8):
            begun = time.perf_counter()
            values_and_gradients(one.tables, 0, points)
            taken.append((time.perf_counter() - begun) / len(points))
        return 1e6 * min(taken)

    return {
        "terms": [{"terms": n, "us": each(form(3, n))} for n in (25, 50, 100, 200, 400)],
        "axes": [{"axes": n, "us": each(form(n, 200))} for n in (2, 3, 4, 5, 6)],
    }


def for_others(folder: Path, training: SnapshotSet, fresh: SnapshotSet, model: Surrogate) -> None:
    """Write the states that others.py gives to other packages: parameters scaled to [0, 1], and the grid."""
    parameters, force = training.states_of("contact", "parameters"), training.states_of("contact", "contact_force")
    outputs, touching = np.column_stack([training.states_of("contact", "tip"), force]), force > 0
    points, true = fresh.random("parameters"), fresh.random("contact_force")
    felt = true > FELT
    description, lead = training.description, training.description.lead
    (other,) = description.other_axes
    onset = CubicSpline(description.tension_nodes[other], training.onset())(points[:, other])
    reach, (lower, upper) = model.evaluate(points).touch_distance, model.limits
    aligned = points.copy()
    aligned[:, lead] = (points[:, lead] - onset) / (upper[lead] - onset)
    aligned[:, -1] = (reach - points[:, -1]) / (reach - lower[-1])
    axes: dict[str, Any] = {f"nodes_{k}": np.array(nodes) for k, nodes in enumerate(description.tension_nodes)}
    axes[f"nodes_{lead}"] = np.array(description.onset_nodes)
    axes[f"nodes_{description.tensions}"] = np.array(description.contact_nodes)
    np.savez(
        folder / "others.npz",
        parameters=(parameters[touching] - lower) / (upper - lower),
        outputs=outputs[touching],
        grid=np.concatenate([training.contact("tip"), training.contact("contact_force")[..., None]], axis=-1),
        points=points[felt],
        scaled=((points - lower) / (upper - lower))[felt],
        aligned=np.clip(aligned, 0, np.append(upper[:-1], 1))[felt],
        force=true[felt],
        **axes,
    )


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", help="out/surrogate by default, out/surrogate-quick if quick")
    parser.add_argument("--quick", action="store_true", help="the draft finger alone, few states")
    options = parser.parse_args()
    folder = Path(options.out or ("out/surrogate-quick" if options.quick else "out/surrogate")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    names = ["draft"] if options.quick else list(JUDGED)
    found: dict = {"accuracy": {}}
    for name in names:
        print(name)
        file = sets.scene(folder, name, options.quick)
        training = sets.training(file)
        fresh, scaling = (
            sets.held_out(file, kind, *((60, drawn[1]) if options.quick else drawn))
            for kind, drawn in (("fresh", sets.FRESH), ("scaling", sets.SCALING))
        )
        model, found["accuracy"][name] = accuracy(training, fresh, scaling)
        say({key: value for key, value in found["accuracy"][name].items() if key != "regimes"})
        if name == "draft":
            found["plain"] = plain(training, fresh)
            found["speed"] = speed(model, folder / "draft.h5", 10_000 if options.quick else 1_000_000)
            found["cost"] = cost()
            if not options.quick:
                found["field"] = field(folder, training, 2000)
            for_others(folder, training, fresh, model)
            for key in ("plain", "speed", "cost", "field"):
                say({key: found.get(key)})
    (folder / "surrogate.json").write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
