"""The picture of docs/accuracy.md: a ball held by three fingers."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from control import Finger
from rom import Rod, Sphere, TouchedSegment
from rom.rod.objects.shapes import RigidObject
from studies.sections import DOCS

BALL, HEIGHT, MOUNTED, FORCE = 0.014, 0.048, 0.024, 1.0  # its radius, height, the fingers' circle [m]; to hold [N]
START = 25.0, 0.0  # tensions to hold from [N]
FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))  # of a plate's corners


def prepare(found: dict, folder: Path) -> dict:
    """Draw it; and the tables' sums."""
    return {
        "held": draw(TouchedSegment.load().rod, DOCS / "segment.png"),
        "objects_in_all": sum(row["objects"] for row in found["robustness"]["verdicts"]),
    }


def draw(finger: Rod, picture: Path) -> dict:
    """Three fingers around a ball, each as it is assembled; their tensions and contact force."""
    figure = plt.figure(figsize=(6.4, 5.6), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    side = 2 * finger.half_lengths[1]
    ball: RigidObject = Sphere(
        centre=(HEIGHT, side / 2 + MOUNTED, 0.0), radius=BALL, direction=(0.0, 1.0, 0.0), distances=(-0.02, 0.02)
    )
    model = TouchedSegment(rod=finger, obstacle=ball)
    motion = Finger(model).hold(FORCE, 0.0, start=START)
    answer = model.answers(np.array([*motion.tensions, 0.0]))
    for k in range(3):
        _finger(axes, finger, motion.tensions, answer.loads[0], 2 * np.pi * k / 3)
    u, v = np.mgrid[0 : 2 * np.pi : 40j, 0 : np.pi : 20j]
    axes.plot_surface(
        1e3 * BALL * np.cos(u) * np.sin(v),
        1e3 * BALL * np.sin(u) * np.sin(v),
        1e3 * (BALL * np.cos(v) - HEIGHT),
        color="tab:orange",
        alpha=0.5,
        linewidth=0,
    )
    axes.set(xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]")
    axes.set_aspect("equal")
    axes.view_init(elev=14, azim=35)
    figure.savefig(picture, dpi=110)
    plt.close(figure)
    return {
        "status": motion.status,
        "force": float(answer.out[0, 3]),
        "tensions": [float(one) for one in motion.tensions],
        "radius_mm": 1e3 * BALL,
        "inside": bool(answer.inside[0]),
    }


def _finger(axes, finger: Rod, tensions: np.ndarray, wrenches: np.ndarray, angle: float) -> None:
    """One finger that hangs from a palm above, its y axis towards the middle: rubber's edges, and plate."""
    placed, side = finger.place(tensions, wrenches), 2 * finger.half_lengths[1]
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * finger.half_lengths
    plate = placed.centres[-1] + corners @ placed.rotations[-1].T
    edges = (finger.edges + finger.displacement(tensions, wrenches)).reshape(-1, 4, 3)
    rubber = np.concatenate([edges[:-1], plate[None, :4]])

    def world(points: np.ndarray) -> np.ndarray:
        x, y, z = np.moveaxis(points, -1, 0)
        out = side / 2 + MOUNTED - y
        across = out * np.cos(angle) - z * np.sin(angle), out * np.sin(angle) + z * np.cos(angle)
        return 1e3 * np.stack([*across, -x], axis=-1)

    for one, other in ((0, 1), (1, 3), (3, 2), (2, 0)):
        strip = world(rubber[:, [one, other]])
        faces = [[*strip[k], *strip[k + 1][::-1]] for k in range(len(strip) - 1)]
        axes.add_collection3d(Poly3DCollection(faces, facecolor="tab:blue", edgecolor="none", alpha=0.55))
    sides = [world(plate)[list(face)] for face in FACES]
    axes.add_collection3d(Poly3DCollection(sides, facecolor="0.35", edgecolor="k", linewidth=0.3))
