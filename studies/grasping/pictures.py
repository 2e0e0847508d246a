"""What the task looks like: a moving picture of one grasp, and a still one of the five shapes in the air.

Drawn off-screen with MuJoCo's own renderer through EGL: no display is needed. MuJoCo has only the plate of a finger;
its rubber is drawn by its outline.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.polynomial.chebyshev import chebfit, chebval
from PIL import Image

from control.mujoco import Simulation
from control.mujoco.solids import SHAPES
from rom import TouchedSegment
from studies.grasping.task import LIFT, PERIOD, attempt, trial
from studies.parts import Run

FIRST = {"box": 15, "sphere": 11, "cylinder": 12, "cone": 13, "mesh": 9}  # trials from which one that is held is sought
TRIED = 100  # from there on, of all shapes, before it is given up
MOVING = "box"  # in the moving picture: one sees it turn
EVERY = 12  # periods from frame to frame
SIZES = {"moving": (360, 400), "still": (200, 220)}  # of a frame, of each solid: width and height [pixels]
# Where the camera stands: the point it looks at [m], distance [m], azimuth and elevation [degrees].
EYES = {"moving": ((0.0, 0.0, 0.086), 0.40, 105.0, -18.0), "still": ((0.0, 0.0, 0.138), 0.21, 112.0, -16.0)}
FIELD = 30  # of view, upright [degrees]
FINER = 2  # times as large it is drawn, then averaged
LAST = 500  # how long the last frame stays [ms]
LEAVING, AWAY = 0.6, 0.04  # how long the gripper rises in the end [s], and how far [m]
BOXES = 60  # of a segment's rubber, from palm to plate
INTO, OVERLAP = 0.0012, 1e-4  # how far they reach into the palm and into each other, so that no gap is seen [m]
RUBBER = np.array([0.98, 0.68, 0.52, 1.0], np.float32)


class Film:
    """Pictures of a trial, taken as it goes on.

    Attributes:
        pictures: "moving", one every EVERY periods; "still", one of the solid in the air, before it is turned.

    Args:
        kind: "moving" or "still".
    """

    def __init__(self, kind: str):
        self.kind, self.pictures = kind, list[Image.Image]()
        self._looks, self._camera = 0, mujoco.MjvCamera()
        camera = self._camera
        camera.lookat[:], camera.distance, camera.azimuth, camera.elevation = EYES[kind]

    def look(self, simulation: Simulation) -> None:
        """To be called after every period."""
        if not self._looks:
            self._open(simulation)
        up = simulation.data.ctrl[2] > LIFT - 1e-6
        if self._looks % EVERY == 0 if self.kind == "moving" else up and not self.pictures:
            self.pictures.append(self.draw(simulation))
        self._looks += 1

    def _open(self, simulation: Simulation) -> None:
        """Make ready to draw its model, whose field of view and shadows are changed."""
        model, large = simulation.model, [FINER * length for length in SIZES[self.kind]]
        look = model.vis
        look.global_.offwidth, look.global_.offheight, look.global_.fovy = *large, FIELD
        look.quality.shadowsize, look.map.znear = 4096, 0.02
        self._simulation, self._graphics = simulation, graphics(*large)
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self._scene, self._whole = mujoco.MjvScene(model, 1000), mujoco.MjrRect(0, 0, *large)

    def draw(self, simulation: Simulation) -> Image.Image:
        """A picture of it now."""
        scene, every, box = self._scene, mujoco.mjtCatBit.mjCAT_ALL.value, mujoco.mjtGeom.mjGEOM_BOX
        option = mujoco.MjvOption()
        mujoco.mjv_updateScene(simulation.model, simulation.data, option, None, self._camera, every, scene)
        for middle, half, axes in rubber(simulation):
            geom = scene.geoms[scene.ngeom]
            mujoco.mjv_initGeom(geom, box, half, middle, axes.ravel(), RUBBER)
            geom.category = mujoco.mjtCatBit.mjCAT_DYNAMIC  # what only decorates casts no shadow
            scene.ngeom += 1
        pixels = np.empty((self._whole.height, self._whole.width, 3), np.uint8)
        mujoco.mjr_render(self._whole, scene, self._context)
        mujoco.mjr_readPixels(pixels, None, self._whole, self._context)
        return Image.fromarray(pixels[::-1]).resize(SIZES[self.kind], Image.Resampling.LANCZOS)

    def leave(self) -> None:
        """Go on while the gripper rises from what it has put down."""
        simulation, steps = self._simulation, round(LEAVING / PERIOD)
        begun = simulation.data.ctrl[2]
        for k in range(steps):
            simulation.data.ctrl[2] = begun + AWAY * (1 - np.cos(np.pi * (k + 1) / steps)) / 2
            simulation.advance(simulation.time + PERIOD)
            self.look(simulation)

    def close(self) -> None:
        """Free the graphics."""
        if self._looks:
            self._context.free()
            self._graphics.free()


def graphics(width: int, height: int) -> Any:
    """EGL, ready; whatever MUJOCO_GL says, which MuJoCo has read when it was first imported.

    Raises:
        SystemExit: there is none.
    """
    try:
        from mujoco.egl import GLContext

        found = GLContext(width, height)
        found.make_current()
    except Exception as failure:  # PyOpenGL has many for a library that is missing
        needed = "libegl1 libgl1-mesa-dri libopengl0 (Debian), pyopengl (pip)"
        raise SystemExit(f"no pictures without EGL; install {needed}: {str(failure).split('. ')[0]}") from None
    return found


def rubber(simulation: Simulation) -> list[tuple[np.ndarray, ...]]:
    """Thin boxes that fill all fingers from palm to plates: middle, half lengths [m], axes in columns."""
    data, found = simulation.data, []
    for spring in simulation.springs:
        segment, before = spring.inverse.segment, simulation.model.body_parentid[spring.body]
        clamp, plate = data.xmat[before].reshape(3, 3), data.xmat[spring.body].reshape(3, 3)
        inputs = np.concatenate([simulation.tensions[spring.finger, spring.pulled], spring.inverse.wrench])
        known = spring.rubber.boxes(data, inputs, segment.struct.knots + 1)
        if known is not None:
            palm = data.xpos[before] - INTO * clamp[:, 0]
            found += smooth(known, palm, np.array([clamp, plate]), segment.half_lengths)
    return found


def smooth(known: tuple[np.ndarray, ...], palm: np.ndarray, frames: np.ndarray, half: np.ndarray) -> list[tuple]:
    """A segment's rubber in BOXES boxes along a smooth curve.

    Args:
        known: it as boxes, at whose ends its places are known: middles, half lengths, axes in columns.
        palm: a point in it, shape (3,) [m].
        frames: axes of the clamp and of the plate, in columns, shape (2, 3, 3).
        half: lengths of its section there, the second and the third [m].
    """
    middles, halves, axes = known
    reach = halves[:, :1] * axes[:, :, 0]
    points = np.vstack([palm, middles - reach, middles[-1] + reach[-1]])
    at = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    at = 2 * at / at[-1] - 1
    cuts = np.linspace(-1, 1, BOXES + 1)
    line = chebval(cuts, chebfit(at, points, 7)).T
    # The sections' sizes and sides, which change little, are known at the boxes' middles.
    there = np.concatenate([at[:1], (at[1:-1] + at[2:]) / 2, at[-1:]])
    values = np.hstack([np.vstack([half, halves, half])[:, 1:], np.vstack([frames[:1], axes, frames[1:]])[:, :, 1]])
    sections = chebval((cuts[1:] + cuts[:-1]) / 2, chebfit(there, values, 3)).T
    found = []
    for begun, stop, (wide, deep, *side) in zip(line, line[1:], sections, strict=False):
        length = np.linalg.norm(stop - begun)
        ahead = (stop - begun) / length
        across = np.cross(ahead, side)
        across /= np.linalg.norm(across)
        frame = np.column_stack([ahead, np.cross(across, ahead), across])
        found.append(((begun + stop) / 2, np.array([length / 2 + OVERLAP, wide, deep]), frame))
    return found


def filmed(model: TouchedSegment, shape: str, kind: str) -> tuple[int, list[Image.Image]]:
    """The first trial of a shape that is held to the end, from FIRST on, and its pictures."""
    for number in range(FIRST[shape], FIRST[shape] + TRIED, len(SHAPES)):
        film = Film(kind)
        held = attempt(model, trial(number, shape), [film.look])["fate"] == "held"
        if held and kind == "moving":
            film.leave()
        film.close()
        if held:
            return number, film.pictures
    raise RuntimeError(f"no {shape} among trials {FIRST[shape]} to {FIRST[shape] + TRIED} is held")


def measure(run: Run) -> dict[str, Any]:
    """Write both pictures into the run's folder: their names, bytes and trials."""
    model, moving, still = TouchedSegment.load(), run.folder / "grasping.webp", run.folder / "grasping_shapes.png"
    number, frames = filmed(model, MOVING, "moving")
    times = [round(1000 * EVERY * PERIOD)] * (len(frames) - 1) + [LAST]
    frames[0].save(moving, save_all=True, append_images=frames[1:], duration=times, loop=0, quality=65, method=6)
    shapes = {shape: filmed(model, shape, "still") for shape in SHAPES}
    row = np.hstack([np.asarray(pictures[0]) for _, pictures in shapes.values()])
    Image.fromarray(row).save(still, optimize=True)
    trials = {shape: k for shape, (k, _) in shapes.items()}
    return {
        "moving": {"file": moving.name, "bytes": moving.stat().st_size, "trial": number, "seconds": sum(times) / 1000},
        "still": {"file": still.name, "bytes": still.stat().st_size, "trials": trials},
    }
