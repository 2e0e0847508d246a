"""A moving picture of a grasp, and a still one of the five shapes in the air, by MuJoCo's renderer (MUJOCO_GL=egl)."""

from __future__ import annotations

import os
from typing import Any

os.environ.setdefault("MUJOCO_GL", "egl")  # without a display; MuJoCo reads it when it is first imported

import mujoco
import numpy as np
from PIL import Image

from control.mujoco import Simulation
from control.mujoco.solids import POSE_ERROR, SHAPES
from rom import TouchedSegment
from studies.grasping.task import LIFT, attempt
from studies.grasping.trials import PERIOD, trial
from studies.parts import Run

FIRST = {"box": 15, "sphere": 11, "cylinder": 12, "cone": 13, "mesh": 9}  # trials from which one that is held is sought
MOVING = "box"  # in the moving picture: its turn is visible
EVERY = 12  # periods from frame to frame
SIZES = {"moving": (360, 400), "still": (200, 220)}  # of a frame, of each solid: width and height [pixels]
# Camera: the point it looks at [m], distance [m], azimuth and elevation [degrees].
EYES = {"moving": ((0.0, 0.0, 0.086), 0.40, 105.0, -18.0), "still": ((0.0, 0.0, 0.138), 0.21, 112.0, -16.0)}
FIELD, FINER = 30, 2  # vertical field of view [degrees]; factor of size by which frames are drawn, then averaged


class Film:
    """Pictures of a trial, taken as it goes on.

    Args:
        kind: "moving", a picture every EVERY periods; "still", one of the solid in the air, before it is turned.
    """

    def __init__(self, kind: str):
        self.kind, self.pictures, self._looks = kind, list[Image.Image](), 0
        self._camera, self._renderer = mujoco.MjvCamera(), list[mujoco.Renderer]()
        self._camera.lookat[:], self._camera.distance, self._camera.azimuth, self._camera.elevation = EYES[kind]

    def look(self, simulation: Simulation) -> None:
        """To be called after every period."""
        is_up = simulation.data.ctrl[2] > LIFT - 1.5 * POSE_ERROR  # the height includes the error found at the table
        if self._looks % EVERY == 0 if self.kind == "moving" else is_up and not self.pictures:
            self.pictures.append(self.draw(simulation))
        self._looks += 1

    def draw(self, simulation: Simulation) -> Image.Image:
        """A picture of the current state."""
        width, height = (FINER * length for length in SIZES[self.kind])
        if not self._renderer:
            view = simulation.model.vis
            view.global_.offwidth, view.global_.offheight, view.global_.fovy = width, height, FIELD
            view.quality.shadowsize, view.map.znear = 4096, 0.02
            self._renderer.append(mujoco.Renderer(simulation.model, height, width))
        (renderer,) = self._renderer
        renderer.update_scene(simulation.data, self._camera)
        return Image.fromarray(renderer.render()).resize(SIZES[self.kind], Image.Resampling.LANCZOS)


def filmed(model: TouchedSegment, shape: str, kind: str) -> tuple[int, list[Image.Image]]:
    """The first trial of a shape that is held to the end, from FIRST on, and its pictures."""
    number = FIRST[shape]
    while True:
        film = Film(kind)
        if attempt(model, trial(number, shape), [film.look])["fate"] == "held":
            return number, film.pictures
        number += len(SHAPES)


def measure(run: Run) -> dict[str, int]:
    """Write both pictures into the study's folder; the trials of the still one by shape."""
    model = TouchedSegment.load()
    _, (first, *frames) = filmed(model, MOVING, "moving")
    duration = round(1000 * EVERY * PERIOD)
    options: dict[str, Any] = {"duration": duration, "loop": 0, "quality": 65, "method": 6}
    first.save(run.folder / "grasping.webp", save_all=True, append_images=frames, **options)
    shapes = {shape: filmed(model, shape, "still") for shape in SHAPES}
    row = np.hstack([np.asarray(pictures[0]) for _, pictures in shapes.values()])
    Image.fromarray(row).save(run.folder / "grasping_shapes.png", optimize=True)
    return {shape: number for shape, (number, _) in shapes.items()}
