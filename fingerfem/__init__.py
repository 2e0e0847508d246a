"""fingerfem: the full-order model of a tendon-driven hyperelastic finger (offline, DOLFINx)."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingerfem.equilibrium.failures import LoadNotReached
    from fingerfem.equilibrium.state import State
    from fingerfem.model import FingerModel
    from fingerfem.scene.scene import Scene, SceneError
    from fingerfem.scene.toml_file import load_scene

__version__ = "0.2.0"
_HOMES = {
    "FingerModel": "model",
    "Scene": "scene.scene",
    "SceneError": "scene.scene",
    "load_scene": "scene.toml_file",
    "State": "equilibrium.state",
    "LoadNotReached": "equilibrium.failures",
}
__all__ = ["FingerModel", "LoadNotReached", "Scene", "SceneError", "State", "load_scene"]


def __getattr__(name: str) -> Any:
    """Import on first use, so that reading a scene does not start MPI and PETSc."""
    if name not in _HOMES:
        raise AttributeError(f"module 'fingerfem' has no attribute {name!r}")
    return getattr(import_module(f"fingerfem.{_HOMES[name]}"), name)
