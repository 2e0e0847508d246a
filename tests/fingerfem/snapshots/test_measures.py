"""Fingers of any measures: their grid lines, the sections of their meshes, and what one mesh hands to another."""

from collections.abc import Iterator

import numpy as np
import pytest
from farm import run
from pydantic import ValidationError

from fingerfem.scene.grid_lines import fitting, in_plate, lines_along, section_mesh
from fingerfem.scene.scene import Scene
from fingerfem.snapshots.design import body
from rom.dataset.grid import levels
from rom.dataset.mesh_transfer import interpolation
from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.samples.section_states import read_section_states

FINGERS = 300
LAW = {"law": "neo-hookean", "C1": 1e5, "D1": 1e-6}
NOT_ROUND = """
name = "not round"
[geometry]
side = 0.0175
segments = [0.080]
plate = 0.00175
[material]
law = "neo-hookean"
C1 = 1.9e6
D1 = 2.43e-7
[[tendons]]
name = "F1"
offset = [0.007, 0.0]
segment = 1
tension = [0.0, 300.0]
[[tendons]]
name = "F2"
offset = [-0.007, 0.0]
segment = 1
tension = [0.0, 300.0]
[load]
force = 15.0
[mesh] # of the preset draft, as is the coarse one
cells = [10, 5]
order = 2
[coarse]
cells = [19, 5]
[sampling]
lines = 4
wrenches = 1
"""


def rounded(random: np.random.Generator, value: float) -> float:
    """A measure as people write it, or as a fit gives it."""
    digits = random.integers(1, 17)
    return float(f"{value:.{digits}g}")


def drawn(random: np.random.Generator) -> dict:
    """A finger of 1 to 200 mm side, with plates, tendons and a pad of random measures."""
    side = rounded(random, 10 ** random.uniform(-3, np.log10(0.2)))
    length = rounded(random, min(side * random.uniform(1.5, 20), 0.9))
    plate = rounded(random, side * random.uniform(0.02, 0.4))
    segments = [length] * int(random.integers(1, 4)) if random.random() < 0.5 else [length]
    geometry = {"side": side, "segments": segments, "plate": plate}
    width = side / 5
    if random.random() < 0.5:
        geometry["channel"] = width = rounded(random, side * random.uniform(0.1, 0.3))
    reach, planar = side / 2 - width / 2, random.random() < 0.5
    # On the axis, beside it with an edge on it, at the face, or anywhere.
    usual = [0.0, width / 2, reach, *(rounded(random, random.uniform(0, reach)) for _ in range(3))]
    offsets = [[random.choice(usual) * random.choice([-1, 1]), 0.0 if planar else random.choice(usual)] for _ in "ab"]
    tendons = [
        {"name": f"F{k}", "offset": [float(value) for value in offset], "segment": 1, "tension": [0.0, 1.0]}
        for k, offset in enumerate(offsets)
    ]
    table = {"name": "drawn", "geometry": geometry, "material": LAW, "tendons": tendons}
    if random.random() < 0.5:
        return table | {"load": {"force": 1.0}}
    total, long = sum(segments), side * random.uniform(0.05, 1)
    end = random.choice([total, total - plate, rounded(random, random.uniform(long, total))])
    pad = {"name": "pad", "x": [max(float(end) - long, 0.0), float(end)], "width": rounded(random, side / 3)}
    return table | {"obstacle": {"distance": [side / 10, side], "method": "penalty", "pad": pad}}


def fingers() -> Iterator[tuple[np.random.Generator, Scene, Scene]]:
    """Scenes that are accepted, on a coarse mesh and on a finer one of twice the order."""
    random, accepted = np.random.default_rng(38), 0
    for _ in range(20 * FINGERS):
        table = drawn(random)
        geometry = table["geometry"]
        along = int(np.ceil(max(geometry["segments"]) / geometry["side"] * 1.5)) + 5 + int(random.integers(0, 9))
        try:
            outline = Scene.model_validate(table | {"mesh": {"cells": [along, 40]}}).outline
            across = fitting(outline, int(random.integers(3, 9)))
            coarse = Scene.model_validate(table | {"mesh": {"cells": [along, across]}})
            fine = Scene.model_validate(
                table | {"mesh": {"cells": [along + 3, fitting(outline, across + 2)], "order": 2}}
            )
        except ValidationError as error:
            refused = str(error)
            assert any(rule in refused for rule in ("thinner", "keep channels apart", "shorter", "hundredth", "40"))
            continue
        yield random, coarse, fine
        accepted += 1
        if accepted == FINGERS:
            return
    pytest.fail(f"only {accepted} scenes were accepted")


def with_middles(lines: np.ndarray, order: int) -> np.ndarray:
    return lines if order == 1 else np.sort(np.concatenate([lines, (lines[1:] + lines[:-1]) / 2]))


def lines_of(scene: Scene) -> list[np.ndarray]:
    wanted = scene.outline.wanted(scene.mesh.cells[1], scene.is_half, scene.mesh.order)
    return [lines_along(scene.outline, scene.mesh), *scene.geometry.shape.lines(wanted)]


def nodes_of(scene: Scene, random: np.random.Generator) -> tuple[list[np.ndarray], np.ndarray]:
    """Coordinates along the axes, and nodes with the round-off of shape functions, sorted by x, y and z."""
    lines = [with_middles(line, scene.mesh.order) for line in lines_of(scene)]
    nodes = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    return lines, nodes * (1 + 2.0**-52 * random.integers(-6, 7, nodes.shape))


def linear(x: np.ndarray) -> np.ndarray:
    return np.column_stack([x @ [1.0, 2.0, 3.0], x[:, 0] - x[:, 1], x[:, 2]])


def check_lines(scene: Scene, lines: list[np.ndarray]) -> None:
    """They contain every plate, and the cells around a tendon have the area of its channel."""
    outline, side = scene.outline, scene.geometry.side
    x, y, z = lines
    assert all(np.abs(x - face).min() < 1e-12 * side for plate in outline.plates for face in plate)
    assert np.abs(y[[0, -1]] / side - [-0.5, 0.5]).max() < 1e-12 and np.abs(z[-1] / side - 0.5) < 1e-12
    section = section_mesh(outline, scene.mesh.cells[1], scene.is_half)
    for column in outline.columns:
        assert section.column_area(column.tag) == pytest.approx(scene.geometry.channel_width**2, rel=2e-5)


def check_sections(scene: Scene, lines: list[np.ndarray], nodes: np.ndarray) -> None:
    """Sections are the grid lines along x, and every node of a plate is known as one."""
    finger, x = body(scene, nodes), lines[0]
    assert len(finger.sections) == len(x) and np.abs(finger.sections - x).max() < scene.outline.tolerance
    for k, (start, end) in enumerate(scene.outline.plates):
        layers = np.sum((x > start * (1 - 1e-9)) & (x < end * (1 + 1e-9)))
        assert in_plate(scene.outline, k, nodes.T).sum() == layers * len(lines[1]) * len(lines[2])


@pytest.mark.long
def test_fingers_of_any_measures_have_lines_sections_and_a_transfer_from_mesh_to_mesh():
    for random, coarse, fine in fingers():
        (own, nodes), (_, targets) = nodes_of(coarse, random), nodes_of(fine, random)
        check_lines(coarse, lines_of(coarse))
        check_sections(coarse, own, nodes)
        assert [len(levels(along)[0]) for along in nodes.T] == [len(line) for line in own]
        single = nodes.astype(np.float32)
        assert [len(levels(along)[0]) for along in single.T] == [len(line) for line in own]
        shuffled = random.permutation(len(nodes))
        brought = interpolation(nodes[shuffled], targets)(linear(nodes[shuffled]).reshape(-1, 1))
        assert np.abs(brought.reshape(-1, 3) - linear(targets)).max() < 1e-12 * np.abs(targets).max()


@pytest.mark.long
def test_a_finger_whose_measures_are_not_round_is_trained_on_two_meshes(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(NOT_ROUND)
    run(2, scene, tmp_path / "coarse", "--coarse")
    report = run(2, scene, tmp_path / "fine", "--near", str(tmp_path / "coarse"))
    assert report["failed"] == 0 and report["states"] == 8
    states = read_section_states(SnapshotSet(tmp_path / "fine"))
    assert len(states.inputs) == 8 and np.isfinite(states.corner_changes).all()
    assert states.at[-1] + states.scene["geometry"]["plate"] == pytest.approx(sum(states.scene["geometry"]["segments"]))
