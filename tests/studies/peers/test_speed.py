"""The bar that CalculiX solves beside this project: its motions, its cells, CalculiX's files."""

import numpy as np
import pytest

from studies.peers.calculix.files import C3D8, Deck, Solved
from studies.peers.calculix.motions import LENGTH, SIDE, block, ends, motions
from studies.peers.question import finger

COUNTS = 3, 2, 2


@pytest.mark.parametrize("name", ["bending", "twist"])
def test_an_end_that_turns_stays_as_it_was(name):
    nodes, _ = block(COUNTS)
    _, end = ends(nodes)
    for places in motions(nodes)[name].path():
        before, after = nodes[end], (nodes + places)[end]
        distances = [np.linalg.norm(points[:, None] - points[None], axis=2) for points in (before, after)]
        assert np.allclose(*distances, rtol=0, atol=1e-15)


def test_the_bent_end_is_that_of_an_arc_as_long_as_the_bar():
    nodes, _ = block(COUNTS)
    _, end = ends(nodes)
    places = motions(nodes)["bending"].path()[-1]
    radius = LENGTH / (np.pi / 2)
    assert np.allclose((nodes + places)[end].mean(axis=0), [radius, SIDE / 2 + radius, SIDE / 2])


def test_cells_fill_the_bar_in_the_order_of_calculix():
    nodes, cells = block(COUNTS)
    corners = nodes[cells[:, C3D8]]
    edges = corners[:, [1, 3, 4]] - corners[:, :1]  # from the first corner to its neighbours
    assert np.linalg.det(edges).sum() == pytest.approx(LENGTH * SIDE**2)
    assert (np.linalg.det(edges) > 0).all()
    assert np.allclose(corners[:, 2], corners[:, 1] + edges[:, 1]) and np.allclose(
        corners[:, 6], corners[:, 2] + edges[:, 2]
    )


def test_no_field_of_the_deck_is_longer_than_calculix_reads():
    nodes, cells = block(COUNTS)
    deck = Deck(nodes=-nodes, cells=cells, finger=finger(), motion=motions(nodes)["bending"], steps=2)
    rows = [line for line in deck.text().splitlines() if not line.startswith("*")]
    assert max(len(field.strip()) for line in rows for field in line.split(",")) <= 20


def test_displacements_come_whole_from_the_file_for_restarts(tmp_path):
    moved = np.random.default_rng(0).normal(size=(5, 3))  # [m]
    printed = "\n".join(f"{k + 1} " + " ".join(f"{1e3 * value:.6e}" for value in row) for k, row in enumerate(moved))
    (tmp_path / "bar.dat").write_text(f"\n displacements (vx,vy,vz) for set ALL and time 1.\n\n{printed}\n")
    arrays = [np.column_stack([np.zeros(5), factor * 1e3 * moved]) for factor in (0.5, 1.0)]
    records = [b"another", *[array.tobytes() for array in arrays]]
    raw = b"".join(len(one).to_bytes(4, "little") + one + len(one).to_bytes(4, "little") for one in records)
    (tmp_path / "bar.rout").write_bytes(raw)
    found = Solved(tmp_path / "bar", 1, 0.0).displacements()
    assert np.allclose(found, moved, rtol=1e-14, atol=0)
