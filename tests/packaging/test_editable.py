"""An editable install overwrites nothing: python-control, which is also imported as `control`, goes on working."""

import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def imported(folder: Path) -> list[str]:
    code = "import control; print(control.__file__, hasattr(control, 'tf'), hasattr(control, 'Gripper'))"
    return subprocess.check_output([sys.executable, "-c", code], cwd=folder, text=True).split()


def test_python_control_works_outside_the_checkout_and_ours_inside(tmp_path):
    try:
        version("control"), version("fingerfem")
    except PackageNotFoundError as missing:
        pytest.fail(f"run by make test in .venv, where both are installed; missing: {missing}")
    file, is_python_control, _ = imported(tmp_path)
    assert "site-packages" in file and is_python_control == "True"
    file, _, is_ours = imported(ROOT)
    assert file == str(ROOT / "control" / "__init__.py") and is_ours == "True"


@pytest.mark.parametrize(
    "package",
    ["rom.rod.touched_segment", "rom.separated.rod_source", "rom.build", "control.finger", "control.campaign"],
)
def test_models_and_control_import_neither_dolfinx_nor_petsc_nor_mpi(package):
    code = f"import sys, {package}; print(*{{name.split('.')[0] for name in sys.modules}})"
    loaded = set(subprocess.check_output([sys.executable, "-c", code], cwd=ROOT, text=True).split())
    assert loaded.isdisjoint({"dolfinx", "petsc4py", "mpi4py", "ufl", "fingerfem"}) and "rom" in loaded
