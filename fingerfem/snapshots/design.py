"""Design of a set: the finger at rest, and the parameters to solve, nodes of a training set or held-out points."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.stats import qmc

from fingerfem.scene.grid_lines import section_mesh
from fingerfem.scene.scene import Scene, SceneError
from fingerfem.scene.sections import PlaneMesh
from fingerfem.snapshots import wrenches
from fingerfem.snapshots.given_points import GivenPoints
from rom.dataset.body import RestBody
from rom.dataset.sections.cross_sections import CrossSections, positions_of
from rom.dataset.sections.plane_nodes import plane_nodes
from rom.dataset.sections.section import outline
from rom.dataset.snapshot_set import Description
from rom.dataset.trainable import check_lines, check_trainable


@dataclass(frozen=True, kw_only=True)
class HeldOut:
    """Held-out points, drawn uniformly over the parameters' ranges.

    Attributes:
        count: of tensions.
        seed: of what is drawn.
        distances: of the plane at each of these; states that share their tensions are solved one after the other, four
            of them for half the iterations that each takes from rest.
    """

    count: int
    seed: int = 0
    distances: int = 1

    def __post_init__(self) -> None:
        for name, value in (("random", self.count), ("distances", self.distances)):
            if value < 1:
                raise ValueError(f"{name} must be at least 1, got {value}")

    def points(self, scene: Scene, box: np.ndarray) -> list[list[float]]:
        """Parameters, shape (count, p), in a box of lower and upper ends, shape (p, 2)."""
        has_obstacle = scene.obstacle is not None
        if not has_obstacle and self.distances > 1:
            raise SceneError(f"distances must be 1 where the scene has no obstacle, got {self.distances}")
        if scene.load is not None:
            random, own = np.random.default_rng(self.seed), box[: len(scene.actuators)]
            loads = own[:, 0] + random.random((self.count, len(own))) * (own[:, 1] - own[:, 0])
            pressed = wrenches.on_plates(scene, random.random((self.count, wrenches.draws(scene))))
            return np.column_stack([loads, pressed]).tolist()
        axes = np.arange(len(box) + self.distances - 1).clip(max=len(box) - 1)
        draw = np.random.default_rng(self.seed).random((self.count, len(axes)))
        drawn = box[axes, 0] + draw * (box[axes, 1] - box[axes, 0])
        if not has_obstacle:
            return drawn.tolist()
        tensions, distances = drawn[:, : len(box) - 1], -np.sort(-drawn[:, len(box) - 1 :])
        points = np.repeat(tensions, self.distances, axis=0)
        return np.column_stack([points, distances.ravel()]).tolist()


FIRST_LINES, MOST_LINES = 16, 512  # of a sequence that grows
# Lines per tension where a scene with a load says nothing of them; seed; tensions whose corners come first.
LINES, SEED, CORNERED = 40, 0, 2
NO_GRID = 2, 8  # nodes that a set without a grid names: few, as products of them are formed
OFF_AXIS = 1e-4  # of a section's centroid over its extent [-]
FIRST = 0.02  # contact node next to touch: forces there are far above the solver's tolerance [-]


def describe(
    scene: Scene, versions: dict[str, str], held_out: HeldOut | GivenPoints | None = None, grows: bool = False
) -> Description:
    """The set of states to solve for a scene.

    Args:
        scene: the scene; its sampling says how fine the grid is, or how many lines a scene with a load has.
        versions: of the software.
        held_out: points to solve instead of training states.
        grows: whether lines are added, of a scene with a load, as the error of its elements needs them.

    Raises:
        SceneError: a chamber no rectangle of a square, no actuator bends the finger towards its plane, the obstacle is
            not the plane y = side/2 + d, or lines are asked for without a load.
        SnapshotError: elements cannot be trained with such a finger, or with so few lines.
    """
    _check_kind(scene)
    sampling, lead = scene.sampling, _lead(scene)
    if scene.load is not None and held_out is None:  # a refusal after hours of solving would be too late
        check_trainable(scene.model_dump(mode="json"))
    if scene.load is None and held_out is None and sampling.lines is not None:
        raise SceneError(
            "lines must be left out where a scene has no load: its training states are a grid of tension_nodes and "
            f"contact_nodes, got {sampling.lines}"
        )
    parameters = scene.parameters
    box = np.array([[parameter["lower"], parameter["upper"]] for parameter in parameters])
    tensions = box[: len(scene.actuators)]
    along_tension, along_contact = sampling.tension_nodes, sampling.contact_nodes
    scattered: list[list[float]] = []
    if scene.load is not None and held_out is None:
        along_tension, along_contact = NO_GRID
        lines = MOST_LINES if grows else sampling.lines or LINES * len(tensions)
        check_lines(lines)
        scattered = _scattered(tensions, lines)
    return Description(
        scene=scene.model_dump(mode="json"),
        fingerprint=scene.fingerprint(),
        parameters=parameters,
        lead=lead,
        tension_nodes=[np.linspace(low, high, along_tension).tolist() for low, high in tensions],
        contact_nodes=np.linspace(FIRST, 1.0, along_contact).tolist(),
        random=held_out.points(scene, box) if held_out else [],
        scattered=scattered,
        wrenches=_pressing(scene, len(scattered)) if scattered else [],
        begins_with=FIRST_LINES if grows else 0,
        versions=versions,
    )


def _check_kind(scene: Scene) -> None:
    """Raise SceneError for what no set of states can have."""
    if scene.chambers and not scene.geometry.shape.is_square:
        raise SceneError(
            "section must be a square of a scene with chambers for snapshots (fingerfem solve takes any), "
            f"got {scene.geometry.shape.shape}"
        )
    if scene.obstacle is not None and not scene.obstacle.is_facing_plane:
        bodies = scene.obstacle.bodies
        got = f"another {bodies[0].shape}" if len(bodies) == 1 else f"{len(bodies)} bodies"
        raise SceneError(f"obstacle must be the plane y = side/2 + d to train on it, got {got}")
    if scene.load is not None and not scene.chambers:
        centre = section_mesh(scene.outline, scene.mesh.cells[1], order=scene.mesh.order).centroid
        most = OFF_AXIS * scene.geometry.side
        if np.abs(centre).max() > most:
            raise SceneError(
                f"{scene.geometry.shape.meshed_by} must give a centroid within {most:.2g} m of the axis, about which "
                f"elements have mass, got y = {centre[0]:.3g}, z = {centre[1]:.3g} m"
            )


def _scattered(box: np.ndarray, lines: int) -> list[list[float]]:
    """Tensions of lines [N], shape (lines, tensions), dense at the box's walls as Chebyshev nodes are.

    Fewer lines are the first ones of more. The box's corners precede the sequence up to `CORNERED` tensions; of more
    tensions they would be most lines of a small set, or all of them with some tendons never pulled.
    """
    count = len(box)
    corners = [list(corner) for corner in product((0.0, 1.0), repeat=count)]
    first = corners if count <= CORNERED else corners[:1]
    # A low-discrepancy sequence: any number of its points fills the box evenly.
    draw = qmc.Sobol(count, seed=SEED).random_base2(int(np.ceil(np.log2(max(lines, 2)))))
    shares = [*first, *((1 - np.cos(np.pi * draw)) / 2).tolist()][:lines]
    return (box[:, 0] + np.array(shares) * (box[:, 1] - box[:, 0])).tolist()


def _pressing(scene: Scene, lines: int) -> list[list[list[float]]]:
    """Wrenches on the plates, shape (lines, states, 6 plates) [N, N m], evenly spread over all that may press."""
    each, draws = scene.sampling.wrenches, wrenches.draws(scene)
    draw = qmc.Sobol(draws, seed=SEED).random_base2(int(np.ceil(np.log2(lines * each))))[: lines * each]
    return wrenches.on_plates(scene, draw).reshape(lines, each, -1).tolist()


def _lead(scene: Scene) -> int:
    """The actuator that bends the finger most towards the plane: by its largest load, lever and length [N m^2]."""
    ends = np.cumsum(scene.geometry.segments)
    bends = [one.tension[1] * one.offset[0] * ends[one.segment - 1] for one in scene.tendons]
    for one in scene.chambers:
        centre, size = np.array(one.centre), np.array(one.size)
        bends.append(-one.pressure[1] * float(size.prod() * centre[0]) * (one.x[1] - one.x[0]))
    lead = int(np.argmax(bends))
    if scene.obstacle is not None and bends[lead] <= 0:
        raise SceneError(
            "tendons must have one on the plane's side (offset y > 0), or chambers one on the other, to sample "
            "contact, got none"
        )
    return lead


def _rubber(scene: Scene) -> PlaneMesh:
    """The mesh of a section without its chambers."""
    mesh = section_mesh(scene.outline, scene.mesh.cells[1], scene.is_half, scene.mesh.order)
    solid = ~np.isin(mesh.tags, [cavity.tag for cavity in scene.outline.cavities])
    return replace(mesh, quads=mesh.quads[solid], tags=mesh.tags[solid])


def body(scene: Scene, nodes: np.ndarray) -> RestBody:
    """The finger of a scene whose mesh has these nodes, shape (nodes, 3) [m]."""
    geometry = scene.geometry
    return RestBody(
        nodes=nodes,
        sections=positions_of(nodes, scene.mesh.order),
        plates=np.array(scene.outline.plates),
        half_lengths=geometry.half_lengths[-1],
        is_half=scene.is_half,
    )


def cross_sections(scene: Scene, nodes: np.ndarray) -> CrossSections:
    """The cross-sections of that finger: of the rubber around its chambers, also where that fills them."""
    mesh = _rubber(scene)
    first = nodes[nodes[:, 0] <= nodes[0, 0] + scene.outline.tolerance, 1:]
    box = outline(scene.model_dump(mode="json")).box
    plane = plane_nodes(first, mesh.points, mesh.quads, box, scene.is_half)
    return CrossSections(nodes, scene.mesh.order, plane)
