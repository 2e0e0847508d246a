"""FElupe's viscoelastic branch at one point, along a history of deformations; a process of its own, as `finger`.

PYTHONPATH=.:out/peers/felupe python3 -m studies.peers.felupe.viscoelastic FILE_IN FILE_OUT

FILE_IN holds deformation gradients, shape (steps, 3, 3), the time between them, and the branch's modulus mu and
viscosity eta; FILE_OUT gets its first Piola-Kirchhoff stresses. The branch is that of Shutov, Landgraf and Ihlemann,
Comput. Methods Appl. Mech. Eng. 265, 2013, doi:10.1016/j.cma.2013.07.004: a neo-Hookean spring of F times the inverse
of an inelastic deformation, which follows by implicit steps.
"""

from __future__ import annotations

import sys
from pathlib import Path

import felupe
import numpy as np


def answer(given: Path, wanted: Path) -> None:
    """Read a history, follow it, write the stresses."""
    with np.load(given) as file:
        history, time, mu, eta = (file[name] for name in ("history", "time", "mu", "eta"))
    constants = {"mu": float(mu), "eta": float(eta), "dtime": float(time)}
    branch = felupe.Hyperelastic(felupe.finite_strain_viscoelastic, nstatevars=6, **constants)
    inelastic, stresses = np.eye(3)[np.triu_indices(3)].reshape(6, 1, 1), []
    for F in history:
        stress, inelastic = branch.gradient([F[:, :, None, None], inelastic])
        stresses.append(stress[:, :, 0, 0])
    np.savez(wanted, stresses=stresses)


if __name__ == "__main__":
    answer(Path(sys.argv[1]), Path(sys.argv[2]))
