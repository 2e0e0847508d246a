"""A finger in MuJoCo as a chain of rigid pieces: what its users take for continuum robots with tendons.

Between two pieces are a hinge of stiffness E I/length and a slide of stiffness E A/length, in the middle of what they
stand for. The cable of earlier versions (composite, plugin) is no more in MuJoCo 4; its successor, a flex of one
dimension, has vertices that cannot turn, so no tendon can run beside it through sites.
"""

from __future__ import annotations

import mujoco

from studies.peers.question import Answers, Finger, finger
from studies.peers.rods.asking import Rubber, answers, ask, refined
from studies.peers.rods.mujoco_rest import HARD, Pace, Resting, options, plane, pulled

# Pieces, and the impedance of the contact (one less it is how far it gives way).
RESOLUTIONS = ((10, HARD), (20, HARD), (40, HARD), (40, 0.99), (80, HARD))
CHOSEN = 2
QUICK = 3  # of them
DENSITY = 1000.0  # [kg/m^3]; where it comes to rest does not depend on it
UNTOUCHED = 'contype="0" conaffinity="0"'  # only the plate meets the plane
PACE = Pace(step=0.005, ramp=20, moved=1e-8, longest=3000)


def xml(finger: Finger, pieces: int, impedance: float) -> str:
    """The model."""
    rubber = Rubber(finger)
    length = rubber.length / pieces
    half = finger.side / 2
    joints = (
        f'<joint type="slide" axis="1 0 0" stiffness="{rubber.axial / length}"/>'
        f'<joint type="hinge" axis="0 0 1" stiffness="{rubber.bending / length}"/>'
    )

    def box(begin: float, end: float, words: str) -> str:
        size = f"{(end - begin) / 2} {half} {half}"
        return f'<geom type="box" pos="{(begin + end) / 2} 0 0" size="{size}" density="{DENSITY}" {words}/>'

    bodies = []
    for k in range(pieces):
        last = k == pieces - 1
        bodies.append(
            f'<body pos="{length if k else length / 2} 0 0">{joints}'
            f"{box(0, length / 2 if last else length, UNTOUCHED)}"
            f'<site name="eyelet{k + 1}" pos="{length / 2} {finger.offset} 0"/>'
        )
    plate = box(length / 2, length / 2 + finger.plate, "") + (
        f'<site name="tip" pos="{(length + finger.plate) / 2} 0 0"/>'
    )
    tendon, motor = pulled([f"eyelet{k}" for k in range(pieces + 1)])
    return (
        f"<mujoco>{options(PACE)}<worldbody>{plane(PACE, impedance)}"
        f'<site name="eyelet0" pos="0 {finger.offset} 0"/>{"".join(bodies)}{plate}{"</body>" * pieces}</worldbody>'
        f"<tendon>{tendon}</tendon><actuator>{motor}</actuator></mujoco>"
    )


def measure(quick: bool = False) -> list[Answers]:
    """Its answers by number of pieces."""
    asked, told, depths = finger(), [], []
    resolutions = RESOLUTIONS[:QUICK] if quick else RESOLUTIONS
    for pieces, impedance in resolutions:
        resting = Resting(xml(asked, pieces, impedance), asked, PACE)
        resting.solve(1.0, None)
        told.append(ask(resting.solve))
        depths.append(1e6 * resting.depth)
    words = {
        "name": "chain of joints, MuJoCo",
        "kind": "simulator",
        "settings": (
            f"MuJoCo {mujoco.__version__}, {resolutions[CHOSEN][0]} pieces with a hinge and a slide, E I and E A per "
            f"length at rest, spatial tendon through sites, motor; integrator discrete, steps of {PACE.step:g} s, "
            f"kinetic damping; contact impedance {HARD}, solref twice the step"
        ),
        "limits": "bends in its plane alone, small strains, no shear, no deformation of the section",
    }
    rows = [
        {"pieces": pieces, "impedance": impedance, "depth_um": depth}
        for (pieces, impedance), depth in zip(resolutions, depths, strict=True)
    ]
    return [answers(words, told[CHOSEN], refined(rows, told))]
