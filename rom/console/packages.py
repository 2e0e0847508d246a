"""Packages that only a part of the project needs: one line names the missing one and what has it."""

from importlib.util import find_spec
from types import TracebackType

ENVIRONMENT = "docker/run python3 -m fingerfem ... has it"
INSTALLED = "pip install -e . installs it; python3 -m fingerfem.doctor lists all that is missing"
TRAINING = f"{ENVIRONMENT}, or pip install -e '.[train]'"
# Sources of packages, by name; the names of those that pip installs anyway are in REQUIRED.
REMEDIES = {
    **dict.fromkeys(("dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py"), ENVIRONMENT),
    **dict.fromkeys(("pydantic", "rich", "matplotlib", "pyvista", "vtkmodules", "PIL"), TRAINING),
    "mujoco": "pip install -e '.[mujoco]'",
    "gymnasium": "pip install -e '.[gymnasium]'",
    "fmpy": "pip install fmpy",
}
SOLVING = ("mpi4py", "petsc4py", "ufl", "dolfinx")  # without one of these, importing another may end the process
DRAWING = ("pyvista", "matplotlib")
REQUIRED = ("numpy", "scipy", "h5py", "cffi", "typer")


class MissingPackage(ImportError):
    """A package that is not installed or does not load: one line."""


def require(*packages: str) -> None:
    """Refuse to begin what needs packages that are not installed.

    Raises:
        MissingPackage: names the first of them and what has it.
    """
    for package in packages:
        if find_spec(package) is None:
            raise MissingPackage(line(package), name=package)


def line(package: str, reason: str = "is not installed") -> str:
    """One line about a package: what is wrong with it and what has it."""
    return f"{package} {reason}: {REMEDIES.get(package, INSTALLED)}"


def explained(error: ImportError) -> str | None:
    """One line about the package whose import failed; None if the project does not name it."""
    if isinstance(error, MissingPackage):
        return str(error)
    package = (error.name or "").partition(".")[0] or _importing(error.__traceback__)
    if package not in REMEDIES and package not in REQUIRED:
        return None
    if isinstance(error, ModuleNotFoundError) and error.name == package:
        return line(package)
    return line(package, f"does not load ({str(error).splitlines()[0]})")


def _importing(trace: TracebackType | None) -> str:
    """The package of the table in which an exception was raised; empty if it was raised in none."""
    importing = ""
    while trace is not None:
        package = str(trace.tb_frame.f_globals.get("__name__", "")).partition(".")[0]
        importing = package if package in REMEDIES or package in REQUIRED else importing
        trace = trace.tb_next
    return importing
