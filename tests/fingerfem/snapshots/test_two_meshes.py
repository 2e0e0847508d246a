"""Many states on a coarse mesh and few on a fine one make a surrogate of the fine one."""

import subprocess
import sys

import numpy as np
import pytest
from farm import ROOT, run

from rom.build import train
from rom.error_model import with_mesh_error
from rom.held_out import check, check_against
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.mesh_transfer import interpolation
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet
from rom.surrogate import Surrogate

DRAFT = (ROOT / "scenes" / "draft.toml").read_text().split("[sampling]")[0]
SECOND = DRAFT[DRAFT.rindex("[[tendons]]") : DRAFT.index("[obstacle]")]
ONE = DRAFT.replace(SECOND, "").replace("tension = [0.0, 100.0]", "tension = [0.0, 60.0]")
OPTIONS = EnrichmentOptions()


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    folder, found = tmp_path_factory.mktemp("meshes"), {}
    for name, cells, lines, options in (
        ("coarse", "[14, 4]", 32, ()),
        ("few", "[20, 6]", 4, ()),
        ("fresh", "[20, 6]", 4, ("--random", "24")),
        ("others", "[20, 6]", 4, ("--random", "16", "--seed", "1")),
        ("coarse_held", "[14, 4]", 32, ("--random", "12")),
    ):
        scene = folder / f"{name}.toml"
        scene.write_text(f"{ONE.replace('[20, 5]', cells)}\n[sampling]\nlines = {lines}\ncontact_nodes = 6\n")
        run(2, scene, folder / name, *options)
        found[name] = SnapshotSet(folder / name)
    return found


def test_few_fine_states_bring_the_fine_mesh_to_a_coarse_surrogate(sets):
    force = {}
    for name, model in (
        ("few alone", train(sets["few"], OPTIONS)),
        ("both", train(sets["few"], OPTIONS, sets["coarse"])),
    ):
        report = check(model, sets["fresh"])
        force[name] = report["contact_force"]["median"]
        assert report["touch"]["wrong_beyond_margin"] == 0
    assert sets["few"].states < sets["coarse"].states / 4
    against = check_against(train(sets["coarse"], OPTIONS), sets["fresh"])
    coarse = train(sets["coarse"], OPTIONS).evaluate(sets["fresh"].random("parameters"))
    true = sets["fresh"].random("contact_force")
    felt = true > 0.1
    force["coarse"] = np.median(np.abs(coarse.contact_force - true)[felt] / true[felt])
    assert against["contact_force"]["median"] == pytest.approx(force["coarse"])
    assert "coverage" not in against["contact_force"] and against["mesh"] == {"cells": [20, 6], "order": 1}
    assert 0.005 < against["displacement"]["median"] < 0.1  # of the mesh, brought from node to node
    assert force["both"] < 0.01 and force["both"] < force["coarse"] / 5 and force["both"] < force["few alone"]
    assert check(model, sets["fresh"])["displacement"]["median"] < 2e-3


def test_what_the_mesh_errs_by_is_part_of_the_error(sets, tmp_path):
    alone = train(sets["coarse"], OPTIONS)
    model = with_mesh_error(alone, sets["fresh"])
    model.save(tmp_path / "model.h5")
    assert Surrogate.load(tmp_path / "model.h5").errors.mesh == model.errors.mesh
    points, true = (sets["others"].random(name) for name in ("parameters", "contact_force"))
    answer, before = model.evaluate(points), alone.evaluate(points)
    for name, error in answer.error.items():
        parts = answer.error_parts
        assert (error == parts["surrogate"][name] + parts["mesh"][name]).all()
        assert (parts["surrogate"][name] == before.error[name]).all()
    taught = check_against(model, sets["fresh"])
    assert taught["taught"] and taught["states"] == 24 and "coverage" not in taught["tip"]
    report = check_against(model, sets["others"])
    assert report["states"] == 16 and not report["taught"]
    assert report["mesh"] == {"cells": [20, 6], "order": 1}
    for name in ("tip", "touch_distance", "displacement", "contact_force"):
        assert report[name]["coverage"] >= 0.75, name  # of 16 states
    off = np.abs(answer.contact_force - true)[true > 0.1]
    assert (off > before.error["contact_force"][true > 0.1]).mean() > 0.5  # the surrogate's own estimate tells nothing
    assert np.median(answer.error["contact_force"][true > 0.1] / off) < 8
    assert check(model, sets["coarse_held"])["contact_force"] == check(alone, sets["coarse_held"])["contact_force"]


def test_a_finer_set_that_does_not_touch_tells_nothing_of_forces(sets):
    free = [
        task for task in sets["fresh"].plan.lines if not (sets["fresh"].only([task]).random("contact_force") > 0).any()
    ]
    with pytest.raises(SnapshotError, match="states that touch"):
        with_mesh_error(train(sets["coarse"], OPTIONS), sets["fresh"].only(free))


def test_states_that_begin_at_a_coarser_mesh_s_are_those_from_rest(sets, tmp_path):
    run(2, sets["fresh"].path.parent / "fresh.toml", tmp_path / "near", "--random", "24", "--near", sets["coarse"].path)
    near, rest = SnapshotSet(tmp_path / "near"), sets["fresh"]
    assert not near.failures and near.iterations < rest.iterations
    for name, bound in (("tip", 1e-8), ("contact_force", 1e-4), ("displacement", 1e-8)):
        assert np.abs(near.random(name) - rest.random(name)).max() < bound


def test_the_model_says_of_which_meshes_it_is(sets):
    provenance = train(sets["few"], OPTIONS, sets["coarse"]).provenance
    assert provenance["fingerprint"] == sets["few"].description.fingerprint
    assert provenance["coarse"]["cells"] == [14, 4] and provenance["coarse"]["states"] == sets["coarse"].states


def test_sets_of_two_fingers_are_refused_in_one_line(sets, tmp_path):
    with pytest.raises(SnapshotError, match="must be of a coarser mesh"):
        train(sets["coarse"], OPTIONS, sets["few"])
    with pytest.raises(SnapshotError, match="must be a training set"):
        train(sets["few"], OPTIONS, sets["fresh"])
    scene = tmp_path / "other.toml"
    scene.write_text(
        ONE.replace("C1 = 1.9e6", "C1 = 1.8e6").replace("[20, 5]", "[10, 4]") + "\n[sampling]\nlines = 3\n"
    )
    run(1, scene, tmp_path / "other")
    command = [sys.executable, "-m", "rom", "build", sets["few"].path, "-o", tmp_path / "model.h5"]
    done = subprocess.run(
        [*map(str, command), "--coarse", str(tmp_path / "other")], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert "must have the material of the fine set" in done.stderr


def test_a_linear_field_is_brought_from_mesh_to_mesh_exactly():
    def nodes(*counts):
        axes = [np.linspace(0, 1, n) for n in counts]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)

    coarse, fine = nodes(4, 3, 5), nodes(7, 6, 6)
    shuffled = coarse[np.random.default_rng(0).permutation(len(coarse))]
    field = lambda x: np.column_stack([x @ [1.0, 2.0, 3.0], x[:, 0], 1 - x[:, 2]])  # noqa: E731
    columns = np.column_stack([field(shuffled).ravel(), 2 * field(shuffled).ravel()])
    brought = interpolation(shuffled, fine)(columns)
    assert brought[:, 0] == pytest.approx(field(fine).ravel(), abs=1e-12)
    assert brought[:, 1] == pytest.approx(2 * field(fine).ravel(), abs=1e-12)
    with pytest.raises(SnapshotError, match="must fill a grid"):
        interpolation(coarse[1:], fine)
