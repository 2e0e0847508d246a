"""Two segments from two maps of one each, against the full-order model of both."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from farm import ROOT, run

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom import Chain, SegmentMap
from rom.segment.training.build import train
from rom.snapshots.snapshot_set import SnapshotSet

pytestmark = pytest.mark.long
FORCE, MOST = 1.0, 20.0  # on the tip [N]; tensions [N]


def scene(folder: Path, name: str, segments: int, offsets: dict[str, float], load: str, lines: int) -> Path:
    """The finger of two_segments.toml, of one or both segments, on few cells."""
    text = (ROOT / "scenes" / "two_segments.toml").read_text()
    head = text.split("[[tendons]]")[0].replace("[0.050, 0.050]", str([0.05] * segments))
    tendons = "".join(
        f'[[tendons]]\nname = "{tendon}"\noffset = [{offset}, 0.0]\nsegment = {min(end, segments)}\n'
        f"tension = [0.0, {MOST}]\n\n"
        for tendon, (offset, end) in offsets.items()
    )
    file = folder / f"{name}.toml"
    sampling = f"[sampling]\nlines = {lines}\nwrenches = 3\n"
    file.write_text(f"{head}{tendons}[load]\n{load}\n\n[mesh]\ncells = [10, 8]\norder = 1\n\n{sampling}")
    return file


@pytest.fixture(scope="module")
def chain(tmp_path_factory) -> Chain:
    folder, maps = tmp_path_factory.mktemp("chain"), []
    both = {"F_s": (0.004, 1), "F_l": (0.003, 1)}
    for name, offsets, load, lines in (
        ("base", both, f"force = {FORCE}\nreach = 0.055", 60),
        ("tip", {"F_l": (0.003, 1)}, f"force = {FORCE}", 30),
    ):
        file = scene(folder, name, 1, offsets, load, lines)
        run(2, file, folder / name)
        maps.append(train(SnapshotSet(folder / name), 600))
    return Chain(maps)


def test_two_maps_are_the_finger_of_both_segments(chain, tmp_path):
    file = scene(tmp_path, "both", 2, {"F_s": (0.004, 1), "F_l": (0.003, 2)}, f"force = {FORCE}", 3)
    finger = FingerModel(Scene.model_validate(tomllib.loads(file.read_text())))
    assert all(isinstance(segment, SegmentMap) for segment in chain.segments)
    random = np.random.default_rng(1)
    for pressed in (0.0, 0.0, 0.5, 0.8):
        tensions = MOST * random.random(2)
        force = random.standard_normal(3)
        force *= pressed * FORCE / np.linalg.norm(force)
        wrenches = np.array([np.zeros(6), [*force, *np.cross([5e-4, 5e-3, -5e-3], force)]])
        state = finger.solve(tensions, wrenches=wrenches, sensitivities=False)
        placed = chain.place(tensions, wrenches)
        assert placed.inside and state.plate_centres is not None
        # The plates are steel, not rigid: a micrometre; the rest is the maps' own error.
        off = np.linalg.norm(placed.centres - state.plate_centres, axis=1)
        assert off.max() < 3e-5, off
