"""rom: separated surrogates from snapshots (numpy, scipy, h5py, cffi; no DOLFINx)."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rom.surrogate import Answer, Surrogate

__all__ = ["Answer", "Surrogate"]


def __getattr__(name: str) -> Any:
    """Import on first use: the snapshot format alone needs no compiled code."""
    if name not in __all__:
        raise AttributeError(f"module 'rom' has no attribute {name!r}")
    return getattr(import_module("rom.surrogate"), name)
