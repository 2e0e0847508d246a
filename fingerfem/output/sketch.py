"""A labelled drawing of a scene's finger at rest, to scale: seen from the side and cut across. It needs no DOLFINx."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from fingerfem.output.dimensions import FONT, INLAY, MM, PAD, RUBBER, arrow, dimension, finish, label, millimetres
from fingerfem.output.section_view import draw_section
from fingerfem.scene.obstacle import Obstacle
from fingerfem.scene.placed import Material
from fingerfem.scene.scene import Scene
from fingerfem.scene.sections import FromFile
from fingerfem.scene.tables import Geometry, Tendon

COLOURS = ("#1565c0", "#2e7d32", "#e07000", "#6a1b9a", "#5d4037", "#00838f", "#827717", "#ad1457")  # of tendons
PLATE, PLANE, ON_PLANE, MATERIAL = "#6b6b6b", "#8fa3ad", "#455a64", "#8a6d35"
WIDTH, SECTION, DOTS_PER_INCH = 9.0, 3.4, 110  # of the drawing, and what its lower half is high [inches]


@dataclass(frozen=True, kw_only=True)
class Frame:
    """Measures of both views: lengths of the scene in mm, and its tendons' colours."""

    geometry: Geometry
    tendons: Sequence[Tendon]

    @property
    def side(self) -> float:
        """Height of the section, along y [mm]."""
        return MM * self.geometry.shape.extents[0]

    @property
    def ends(self) -> np.ndarray:
        """Ends of the segments along x, shape (segments,) [mm]."""
        return MM * np.cumsum(self.geometry.segments)

    @property
    def length(self) -> float:
        """Length of the finger [mm]."""
        return float(self.ends[-1])

    @property
    def unit(self) -> float:
        """The height of a line of text beside the finger, seen from the side [mm]."""
        return 0.032 * self.length

    def height(self, obstacle: Obstacle) -> float:
        """The distance d at which an obstacle is drawn: near the finger, within its range [mm]."""
        return float(np.clip(max(0.8 * self.side, 4 * self.unit), *(MM * np.array(obstacle.distance))))


def sketch(scene: Scene) -> Figure:
    """The drawing: side view above; below it the section, seen from the clamp, and what the letters mean.

    An obstacle that is not the plane y = side/2 + d is drawn by its cut with z = 0.

    Args:
        scene: any; of its loads, ranges are drawn and not values.

    Example:
        >>> from fingerfem import load_scene
        >>> sketch(load_scene("scenes/draft.toml")).savefig("draft.png")
    """
    frame = Frame(geometry=scene.geometry, tendons=scene.tendons)
    left, right, lowest, highest = _limits(scene, frame)
    above = WIDTH * (highest - lowest) / (right - left) + 0.6  # inches, its axis' numbers included
    figure = Figure(figsize=(WIDTH, above + SECTION), layout="constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=[above, SECTION], width_ratios=[1, 1.6])
    side, section, words = (figure.add_subplot(cell) for cell in (grid[0, :], grid[1, 0], grid[1, 1]))
    _finger(side, frame)
    _materials(side, frame, scene.materials)
    _pulls(side, frame)
    _dimensions(side, frame)
    if scene.obstacle is not None:
        _obstacle(side, frame, scene.obstacle)
    if scene.load is not None:
        _load(side, frame, scene.load.force)
    side.set(xlim=(left, right), ylim=(lowest, highest))
    finish(side, "x [mm]", "y [mm]")
    draw_section(section, scene, _colours(frame))
    _explain(words, scene, frame)
    return figure


def write_sketch(scene: Scene, picture: str | Path) -> None:
    """Write the drawing in the format that the file's ending names, PNG for one.

    Raises:
        ValueError: the ending names none that matplotlib writes.
    """
    figure = sketch(scene)
    known = figure.canvas.get_supported_filetypes()
    if Path(picture).suffix.removeprefix(".") not in known:
        raise ValueError(f"picture must end in one of {', '.join(sorted(known))}, got {picture}")
    Path(picture).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture, dpi=DOTS_PER_INCH)


def _limits(scene: Scene, frame: Frame) -> tuple[float, float, float, float]:
    """Extent of the view from the side: left, right, lowest, highest [mm]."""
    half, unit = frame.side / 2, frame.unit
    letters = max(len(", ".join(names)) for names in _by_height(frame).values())
    above, below = (5.0 if scene.load else 4.2) * unit, 4.4 * unit
    if scene.obstacle is not None and scene.obstacle.is_facing_plane:
        above = frame.height(scene.obstacle) + 2 * unit
    elif scene.obstacle is not None:
        above = 0.8 * frame.length
        below = above if scene.obstacle.centre and scene.obstacle.centre[1] < 0 else below
    return -(5.4 + 0.62 * letters) * unit, frame.length + 8 * unit, -half - below, half + above


def _by_height(frame: Frame) -> dict[float, list[str]]:
    """Names of the tendons that lie at the same y [m], from the highest down."""
    heights = sorted({tendon.offset[0] for tendon in frame.tendons}, reverse=True)
    return {y: [tendon.name for tendon in frame.tendons if tendon.offset[0] == y] for y in heights}


def _apart(heights: np.ndarray, least: float) -> np.ndarray:
    """The same descending heights, moved about their mean so far that none is nearer to the next than the least."""
    falls = np.maximum(-np.diff(heights), least)
    moved = -np.concatenate([[0.0], np.cumsum(falls)])
    return np.asarray(moved - moved.mean() + heights.mean())


def _colours(frame: Frame) -> list[tuple[Tendon, str]]:
    return list(zip(frame.tendons, COLOURS, strict=False))


def _finger(axes: Axes, frame: Frame) -> None:
    """Rubber, plates and clamp, seen along -z; the axes x, y and z where the finger is clamped."""
    half, unit = frame.side / 2, frame.unit
    x = np.append(0.0, np.ravel(frame.geometry.plates))
    y = half * frame.geometry.size_at(x)
    axes.fill(MM * np.concatenate([x, x[::-1]]), np.concatenate([y, -y[::-1]]), fc=RUBBER, ec="0.4")
    for (begin, _), (thick, high, _) in zip(frame.geometry.plates, 2 * MM * frame.geometry.half_lengths, strict=True):
        axes.add_patch(Rectangle((MM * begin, -high / 2), thick, high, fc=PLATE, ec=PLATE))
    axes.add_patch(Rectangle((-2 * unit, -1.2 * half), 2 * unit, 2.4 * half, fc="0.93", ec="0.6", hatch="////"))
    axes.text(-0.3 * unit, -1.2 * half - 0.3 * unit, "clamp", ha="right", va="top", fontsize=FONT)
    axes.plot([0, frame.length], [0, 0], ls="-.", color="0.5", lw=0.8)
    arrow(axes, (frame.length, 0), (frame.length + 3 * unit, 0), "x", (0.6 * unit, 0))
    arrow(axes, (0, half), (0, half + 2.4 * unit), "y", (0, 0.7 * unit))
    axes.plot([0], [0], "o", ms=10, mfc="white", mec="0.1", zorder=5)
    axes.plot([0], [0], ".", ms=4, color="0.1", zorder=6)
    axes.text(0.5 * unit, -0.2 * unit, "z", ha="left", va="top", style="italic", fontsize=FONT, zorder=6)


def _materials(axes: Axes, frame: Frame, materials: Sequence[Material]) -> None:
    """Other materials between the plates, seen along -z; groups of a file are in the section alone."""
    begins = [0.0, *(end for _, end in frame.geometry.plates)]
    for one in materials:
        if one.region == "group":
            continue
        middle, half = (one.centre[0], one.size[0] / 2) if one.centre and one.size else (0.0, frame.side / 2 / MM)
        low, high = (0.0, np.inf) if one.x is None else one.x
        for begin, (end, _) in zip(begins, frame.geometry.plates, strict=False):
            x = np.clip([begin, end], low, high)
            y = np.outer([middle - half, middle + half], frame.geometry.size_at(x))
            if x[0] < x[1]:
                axes.fill(
                    MM * np.concatenate([x, x[::-1]]), MM * np.concatenate([y[0], y[1][::-1]]), fc=INLAY, ec="0.4"
                )


def _pulls(axes: Axes, frame: Frame) -> None:
    """Tendons from the plates they end in through the clamp, where they are pulled; names beside, one a height."""
    unit, start = frame.unit, -2 * frame.unit
    groups = _by_height(frame)
    for (height, names), named in zip(groups.items(), _apart(MM * np.array(list(groups)), 1.4 * unit), strict=True):
        y = MM * height
        alike = [(tendon, colour) for tendon, colour in _colours(frame) if tendon.name in names]
        # Behind one another: the longest below, so that all are seen to end.
        for tendon, colour in sorted(alike, key=lambda pair: -pair[0].segment):
            end = np.mean(frame.geometry.plates[tendon.segment - 1])
            x = np.array([start / MM, 0.0, *np.ravel(frame.geometry.plates[: tendon.segment])[:-1], end])
            dashes, x = ("--", x[[0, 1, -1]]) if tendon.path == "straight" else ("-", x)
            high = y * frame.geometry.size_at(x)
            axes.plot(MM * x, high, dashes, color=colour, lw=2.2, zorder=3)
            axes.plot(MM * x[-1:], high[-1:], "o", color=colour, ms=7, mec="white", zorder=4)
        colour = alike[0][1] if len(alike) == 1 else "0.1"
        look = {"arrowstyle": "-|>", "color": colour, "lw": 2, "shrinkA": 0}
        axes.annotate("", (start - 2.6 * unit, named), (start, y), arrowprops=look)
        where = (start - 2.8 * unit, named)
        axes.text(*where, ", ".join(names), ha="right", va="center", color=colour, fontsize=FONT)


def _dimensions(axes: Axes, frame: Frame) -> None:
    """Lengths of the segments and the thickness of a plate."""
    half, unit = frame.side / 2, frame.unit
    below = -half - 2.6 * unit
    for k, (start, end) in enumerate(zip([0.0, *frame.ends[:-1]], frame.ends, strict=True)):
        name = f"segment {k + 1}: " if len(frame.ends) > 1 else "segment: "
        dimension(axes, (start, below), (end, below), name + millimetres(end - start), (0, -0.3 * unit))
        for x in (start, end):
            axes.plot([x, x], [-half, below - 0.4 * unit], color="0.6", lw=0.7)
    thick, high, _ = MM * frame.geometry.half_lengths[-1]
    at = (frame.length + 1.5 * unit, -half - 1.4 * unit)
    label(axes, f"plate, {millimetres(2 * thick)}", (frame.length - thick, -high), at)


def _obstacle(axes: Axes, frame: Frame, obstacle: Obstacle) -> None:
    """The obstacle at one of its distances, d, and the pad."""
    half, unit, d = frame.side / 2, frame.unit, frame.height(obstacle)
    if not obstacle.is_facing_plane:
        return _cut(axes, frame, obstacle)
    y, start, end = half + d, -2 * unit, frame.length + 6 * unit
    axes.add_patch(Rectangle((start, y), end - start, 1.6 * unit, fc=PLANE, alpha=0.5, ec="none"))
    axes.plot([start, end], [y, y], color=ON_PLANE, lw=1.8)
    axes.text(end - 0.4 * unit, y + 0.8 * unit, "rigid plane", ha="right", va="center", fontsize=FONT)
    lowest, highest = (MM * value for value in obstacle.distance)
    middle = 0.4 * frame.length
    dimension(axes, (middle, half), (middle, y), f"d = {lowest:g} to {millimetres(highest)}", (0.5 * unit, 0))
    if obstacle.pad is not None:
        x = np.array(obstacle.pad.x)
        face = half * frame.geometry.size_at(x)
        axes.plot(MM * x, face, color=PAD, lw=5, solid_capstyle="butt", zorder=5)
        label(axes, "pad", (MM * float(x.mean()), float(face.mean())), (frame.length + 1.5 * unit, half + 1.4 * unit))


def _cut(axes: Axes, frame: Frame, obstacle: Obstacle) -> None:
    """Draws the cuts of other bodies, at their nearest distances, with the plane z = 0."""
    from fingerfem.mechanics.obstacles import NUMPY, bodies

    reach = 1.5 * frame.length / MM
    x, y = np.meshgrid(np.linspace(-0.2 * reach, reach, 301), np.linspace(-reach, reach, 301))
    d, all_of_them = obstacle.distance[0], bodies(obstacle, frame.geometry.shape.top)
    outside = np.min([one.signed_distance((x, y, 0 * x), d, NUMPY) for one in all_of_them], axis=0)
    if outside.min() < 0:
        axes.contourf(MM * x, MM * y, outside, [-np.inf, 0.0], colors=[PLANE], alpha=0.5)


def _load(axes: Axes, frame: Frame, force: float) -> None:
    """Draws the largest force on every plate."""
    unit = frame.unit
    for k, (plate, half) in enumerate(zip(frame.geometry.plates, MM * frame.geometry.half_lengths[:, 1], strict=True)):
        x = MM * float(np.mean(plate))
        look = {"arrowstyle": "-|>", "color": PAD, "lw": 2.5, "mutation_scale": 18, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (x, half), (x - 0.8 * unit, half + 3 * unit), arrowprops=look)
        name = f"w{k + 1}" if len(frame.ends) > 1 else "wrench w"
        place = (x - unit, half + 3.2 * unit)
        axes.text(*place, f"{name}: force up to {force:g} N", ha="right", va="bottom", color=PAD, fontsize=FONT)


def _explain(axes: Axes, scene: Scene, frame: Frame) -> None:
    """One line for every tendon, for what may touch and for the pad."""
    lines = []
    for tendon, colour in _colours(frame):
        y, z = MM * np.array(tendon.offset)
        plate = f"plate {tendon.segment}" if len(frame.ends) > 1 else "the plate"
        low, high = tendon.tension
        lines.append((f"{tendon.name}: y = {y:g}, z = {z:g} mm, ends in {plate}, {low:g} to {high:g} N", colour))
    if any(tendon.path == "channel" for tendon in frame.tendons):
        shapes = "squares" if frame.geometry.shape.has_face else "coloured cells"
        wide = f", {millimetres(MM * frame.geometry.channel_width)} wide"
        is_read = isinstance(frame.geometry.shape, FromFile)
        lines.append((f"{shapes}: channels{'' if is_read else wide}", "0.25"))
    for one in scene.materials:
        lines.append((f"{one.name}: {one.material.law}, E = {one.material.young_modulus / 1e6:.3g} MPa", MATERIAL))
    obstacle = scene.obstacle
    if obstacle is not None and obstacle.is_facing_plane:
        drawn = millimetres(frame.height(obstacle))
        face = "side/2" if frame.geometry.shape.is_square else millimetres(MM * frame.geometry.shape.top)
        lines.append((f"plane: y = {face} + d; drawn at d = {drawn}", ON_PLANE))
    elif obstacle is not None:
        near, far = (MM * value for value in obstacle.distance)
        shapes = ", ".join(one.shape for one in obstacle.bodies)
        lines.append((f"{shapes}: d = {near:g} to {millimetres(far)}; cut z = 0, at {millimetres(near)}", ON_PLANE))
    if obstacle is not None and obstacle.pad is not None:
        start, stop = (MM * value for value in obstacle.pad.x)
        lines.append((f"pad {obstacle.pad.name}: x = {start:g} to {millimetres(stop)}", PAD))
    if scene.load is not None:
        lines.append(
            ("w: fx, fy, fz [N], mx, my, mz [N m] about the\nplate's centre, in axes that turn with the plate", PAD)
        )
    at = 0.97
    for line, colour in lines:
        axes.text(0.0, at, line, color=colour, va="top", fontsize=FONT, transform=axes.transAxes)
        at -= 0.11 * (1 + line.count("\n"))
    axes.set_axis_off()
