"""Rules between a scene's tables, of section, chambers, materials and obstacle: ValueError with name, rule, value."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from fingerfem.scene.obstacle import Obstacle
from fingerfem.scene.placed import Chamber, Material
from rom.dataset.geometry import END

if TYPE_CHECKING:
    from fingerfem.scene.scene import Scene


def check_section(scene: Scene) -> None:
    """Channels lie within the section and apart; what needs a square or a flat face has it."""
    section, width = scene.geometry.shape, scene.geometry.channel_width
    for k, column in enumerate(columns := scene.outline.columns):
        if refused := section.refusal(column, width):
            raise ValueError(f"tendons.{k}.offset {refused}, got {column.offset.tolist()}")
        for other, tendon in zip(columns[:k], scene.tendons, strict=False):
            shared = column.path == other.path == "channel" and scene.tendons[k].segment != tendon.segment
            if not section.are_apart(column, other, width) and not (shared and column.tag == other.tag):
                raise ValueError(
                    f"tendons.{k}.offset must keep channels apart (geometry.channel is {width:g} m wide), or share "
                    f"the channel of a tendon that ends at another plate, "
                    f"got {column.offset.tolist()} beside {other.name} at {other.offset.tolist()}"
                )
    if scene.obstacle is not None and scene.obstacle.pad is not None and not section.has_face:
        raise ValueError(
            f"obstacle.pad must be left out of a scene with a {section.shape} section: a pad lies on the flat face "
            f"of a square or a rectangle, got {scene.obstacle.pad.name}"
        )


def check_chambers(scene: Scene) -> None:
    """Chambers lie in a segment's rubber, apart from channels and from each other."""
    if not scene.chambers:
        return
    if scene.coarse is not None:
        raise ValueError(
            "coarse must be left out of a scene with chambers: states are brought to other meshes without voids alone, "
            f"got cells {scene.coarse.cells}"
        )
    region, least = scene.geometry.shape.chamber_region, scene.geometry.side / 100
    for k, chamber in enumerate(scene.chambers):
        if scene.parameter_names.count(chamber.name) > 1 or chamber.name == "d":
            raise ValueError(f"chambers.{k}.name must be unique and no other parameter's, got {chamber.name}")
        ordered(f"chambers.{k}.pressure", chamber.pressure)
        ordered(f"chambers.{k}.x", chamber.x)
        if chamber.region != region:
            rule = f"be {region!r}" if region else "not be given; take a ring, rectangle, square or file"
            raise ValueError(
                f"chambers.{k}.region must {rule} with a {scene.geometry.shape.shape} section, got {chamber.region!r}"
            )
        _check_span(scene, k, chamber, least)
        _check_block(scene, k, chamber, least)
        if scene.load is not None:
            _check_ends(scene, k, chamber)


def _check_span(scene: Scene, k: int, chamber: Chamber, least: float) -> None:
    """A chamber lies between the ends of one segment's rubber, apart from others of the same region."""
    spans, near = _rubber(scene), scene.outline.tolerance
    if not any(a - near <= chamber.x[0] and chamber.x[1] <= b + near for a, b in spans):
        where = " or ".join(f"[{a:g}, {b:g}]" for a, b in spans)
        raise ValueError(f"chambers.{k}.x must lie in the rubber of one segment, {where} m, got {chamber.x}")
    tags = [cavity.tag for cavity in scene.outline.cavities]
    apart = [
        max(other.x[0] - chamber.x[1], chamber.x[0] - other.x[1])
        for other, tag in zip(scene.chambers[:k], tags, strict=False)
        if tag == tags[k]
    ]
    for value in (chamber.x[1] - chamber.x[0], *apart):
        if value < least * (1 - 1e-9):
            raise ValueError(
                f"chambers.{k}.x must be at least a hundredth of the side ({least:g} m) long, and as far from another "
                f"chamber of the same region, got {value:g}"
            )


def _rubber(scene: Scene) -> list[tuple[float, float]]:
    """Start and end of every segment's rubber [m]."""
    begins = [0.0, *(end for _, end in scene.outline.plates)]
    return list(zip(begins, (begin for begin, _ in scene.outline.plates), strict=False))


def _check_ends(scene: Scene, k: int, chamber: Chamber) -> None:
    """Requires that a chamber of a finger for elements ends within its segment's end pieces, and not at its clamp."""
    side, near = END * scene.geometry.side, scene.outline.tolerance
    first, last = next((a, b) for a, b in _rubber(scene) if chamber.x[1] <= b + near)
    if not (near < chamber.x[0] - first < side + near and last - side - near < chamber.x[1]):
        raise ValueError(
            f"chambers.{k}.x must begin within one side of its segment's clamp, not at it, and end within one side of "
            f"the plate, ({first:g}, {first + side:g}] and [{last - side:g}, {last:g}] m, where elements are trained "
            f"(load), got {chamber.x}"
        )


def _check_block(scene: Scene, k: int, chamber: Chamber, least: float) -> None:
    """A rectangle lies within the section, apart from channels and from other rectangles."""
    if chamber.centre is None or chamber.size is None:
        return
    centre, half = np.array(chamber.centre), np.array(chamber.size) / 2
    wall = float((np.array(scene.geometry.shape.extents) / 2 - np.abs(centre) - half).min())
    if wall < least * (1 - 1e-9):
        raise ValueError(
            f"chambers.{k}.size must leave a wall of at least a hundredth of the side, {least:g} m, got {wall:g}"
        )
    width = np.full(2, scene.geometry.channel_width)
    blocks = [(one.name, np.array(one.offset), width / 2, 0.0) for one in scene.tendons]
    blocks += [
        (one.name, np.array(one.centre), np.array(one.size) / 2, least)
        for one in scene.chambers[:k]
        if (one.centre, one.size) != (chamber.centre, chamber.size)
    ]
    for name, other, its_half, gap in blocks:
        away = float((np.abs(centre - other) - half - its_half).max())
        if away < gap - scene.outline.tolerance:
            got = f"{away:g} m from" if away >= 0 else f"an overlap of {-away:g} m with"
            raise ValueError(
                f"chambers.{k}.centre must be such that no channel, straight tendon or other chamber meets it "
                f"(at least {gap:g} m away), got {got} {name}"
            )


def check_density(scene: Scene) -> None:
    """Weight has densities, from one table."""
    if scene.gravity is None:
        return
    if scene.density is None and scene.gravity.density is None:
        raise ValueError("gravity.density must be given, or a table [density], got neither")
    twice = sorted({"density", "plate_density"} & scene.gravity.model_fields_set)
    if scene.density is not None and twice:
        raise ValueError(
            f"gravity.{twice[0]} must be left out where [density] has it, got {getattr(scene.gravity, twice[0])}"
        )


def check_materials(scene: Scene) -> None:
    """Other materials lie in the finger and have no cells in common."""
    shape, least = scene.geometry.shape, scene.geometry.side / 100
    regions = ["section", *(one for one in ("rectangle", "group") if one == shape.chamber_region)]
    for k, one in enumerate(scene.materials):
        if one.name == "rubber" or [other.name for other in scene.materials].count(one.name) > 1:
            raise ValueError(f"materials.{k}.name must be unique and not 'rubber', that of [material], got {one.name}")
        if one.region not in regions:
            raise ValueError(
                f"materials.{k}.region must be {' or '.join(map(repr, regions))} with a {shape.shape} section, "
                f"got {one.region!r}"
            )
        if one.x is not None:
            ordered(f"materials.{k}.x", one.x)
            if one.x[1] - one.x[0] < least * (1 - 1e-9) or one.x[1] > scene.geometry.length + scene.outline.tolerance:
                raise ValueError(
                    f"materials.{k}.x must be at least a hundredth of the side ({least:g} m) long and end on the "
                    f"finger, at most at {scene.geometry.length:g} m, got {one.x}"
                )
        if one.centre is not None and one.size is not None:
            beyond = np.abs(one.centre) + np.array(one.size) / 2 - np.array(shape.extents) / 2
            if beyond.max() > scene.outline.tolerance:
                raise ValueError(f"materials.{k}.size must end within the section, got {beyond.max():.3g} m beyond it")
    for (_, one), (k, other) in combinations(enumerate(scene.materials), 2):
        if _overlap(one, other, scene.outline.tolerance):
            raise ValueError(
                f"materials.{k}.region must have no cells of another material, as other limits x or another centre "
                f"give, got some of {one.name}"
            )


def _overlap(one: Material, other: Material, near: float) -> bool:
    """True if two materials share cells; groups of a file do not."""
    spans = [(0.0, np.inf) if part.x is None else part.x for part in (one, other)]
    if min(span[1] for span in spans) - max(span[0] for span in spans) <= near:
        return False
    if "section" in (one.region, other.region):
        return True
    if one.centre is None or other.centre is None or one.size is None or other.size is None:
        return False
    apart = np.abs(np.subtract(one.centre, other.centre)) - np.add(one.size, other.size) / 2
    return bool(apart.max() < -near)


def check_obstacle(scene: Scene, obstacle: Obstacle) -> None:
    """An obstacle fits the finger, its rubber and its pad."""
    ordered("obstacle.distance", obstacle.distance)
    if obstacle.method == "nitsche" and scene.material.is_mixed:
        raise ValueError(
            "obstacle.method must be penalty where the rubber is nearly incompressible: its stress on the surface, "
            "which nitsche needs, is not that of the displacements, got nitsche"
        )
    if obstacle.method == "nitsche" and scene.materials:
        raise ValueError(
            "obstacle.method must be penalty with several materials: nitsche takes the surface's stress by one law, "
            "got nitsche"
        )
    if obstacle.method == "nitsche" and obstacle.stiffness_factor < 20:
        raise ValueError(
            "obstacle.stiffness must be at least 20 for nitsche, below which its potential has no minimum, "
            f"got {obstacle.stiffness_factor:g}"
        )
    if obstacle.pad is not None:
        ordered("obstacle.pad.x", obstacle.pad.x)
        least = scene.geometry.side / 100
        if min(obstacle.pad.x[1] - obstacle.pad.x[0], obstacle.pad.width or least) < least * (1 - 1e-9):
            raise ValueError(
                f"obstacle.pad must be at least a hundredth of the side long and wide ({least:g} m), "
                f"got x {obstacle.pad.x}, width {obstacle.pad.width}"
            )
        if obstacle.pad.x[1] > scene.geometry.length * (1 + 1e-9):
            raise ValueError(
                f"obstacle.pad.x must lie on the finger, [0, {scene.geometry.length:g}] m, got {obstacle.pad.x}"
            )
        widest = scene.geometry.shape.extents[1]
        if (obstacle.pad.width or 0) > widest:
            raise ValueError(f"obstacle.pad.width must be at most the side, {widest:g} m, got {obstacle.pad.width}")


def ordered(field: str, limits: list[float]) -> None:
    """The lowest is below the highest."""
    if limits[0] >= limits[1]:
        raise ValueError(f"{field} must be [lowest, highest] with lowest < highest, got {limits}")
