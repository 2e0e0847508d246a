"""fingerfem: the full-order model of a tendon-driven hyperelastic finger (offline, DOLFINx)."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingerfem.convergence import LoadNotReached
    from fingerfem.model import FingerModel
    from fingerfem.scene import Scene, SceneError
    from fingerfem.scene_file import load_scene
    from fingerfem.state import State

__version__ = "0.1.0"
_HOMES = {
    "FingerModel": "model",
    "Scene": "scene",
    "SceneError": "scene",
    "load_scene": "scene_file",
    "State": "state",
    "LoadNotReached": "convergence",
}
__all__ = ["FingerModel", "LoadNotReached", "Scene", "SceneError", "State", "load_scene"]


def __getattr__(name: str) -> Any:
    """Import on first use, so that reading a scene does not start MPI and PETSc."""
    if name not in _HOMES:
        raise AttributeError(f"module 'fingerfem' has no attribute {name!r}")
    return getattr(import_module(f"fingerfem.{_HOMES[name]}"), name)
