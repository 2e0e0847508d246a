"""Rules between a scene's tables: of its section and its obstacle. They raise ValueError: name, rule, value."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fingerfem.scene.obstacle import Obstacle

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
    if scene.load is not None and not section.is_square:
        raise ValueError(
            f"load must be left out of a scene with a {section.shape} section: rod elements have square ones "
            f"(geometry.side); solve it without, or in front of an obstacle, got force {scene.load.force:g}"
        )
    if scene.coarse is not None and not section.is_square:
        raise ValueError(
            f"coarse must be left out of a scene with a {section.shape} section: snapshots have square ones "
            f"(geometry.side), got cells {scene.coarse.cells}"
        )
    if scene.obstacle is not None and scene.obstacle.pad is not None and not section.has_face:
        raise ValueError(
            f"obstacle.pad must be left out of a scene with a {section.shape} section: a pad lies on the flat face "
            f"of a square or a rectangle, got {scene.obstacle.pad.name}"
        )


def check_obstacle(scene: Scene, obstacle: Obstacle) -> None:
    """An obstacle fits the finger, its rubber and its pad."""
    ordered("obstacle.distance", obstacle.distance)
    if obstacle.method == "nitsche" and scene.material.is_mixed:
        raise ValueError(
            "obstacle.method must be penalty where the rubber is nearly incompressible: its stress on the surface, "
            "which nitsche needs, is not that of the displacements, got nitsche"
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
