"""docker/run as its users call it; inside the environment it takes the host's engine."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from farm import ROOT

SCRIPT = """
import fingerfem, rom, control
from pathlib import Path
from mpi4py import MPI
roots = {str(Path(package.__file__).resolve().parents[1]) for package in (fingerfem, rom, control)}
assert len(roots) == 1
MPI.COMM_WORLD.Barrier()
print(roots.pop(), Path.cwd(), MPI.COMM_WORLD.size)
"""


@pytest.fixture
def mine() -> Iterator[Path]:
    """A folder of a user's own, two levels below one of the checkout's."""
    (ROOT / "out").mkdir(exist_ok=True)
    top = Path(tempfile.mkdtemp(dir=ROOT / "out"))
    folder = top / "my own" / "scripts"
    folder.mkdir(parents=True)
    (folder / "try.py").write_text(SCRIPT)
    yield folder
    shutil.rmtree(top)


def run(*line: str, folder: Path = ROOT, **settings: str) -> subprocess.CompletedProcess[str]:
    """docker/run without what this process was started with: no PYTHONPATH, and no rank of another mpirun."""
    kept = {name: value for name, value in os.environ.items() if name in ("HOME", "LANG", "PATH", "XDG_CACHE_HOME")}
    return subprocess.run(
        [str(ROOT / "docker" / "run"), *line],
        cwd=folder,
        env=kept | {"FINGERFEM_ENGINE": "host"} | settings,
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_script_anywhere_in_the_checkout_imports_its_packages(mine, ranks):
    way = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    done = run(*way, "python3", str((mine / "try.py").relative_to(ROOT)))
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [f"{ROOT} {ROOT} {ranks}"] * ranks


def test_called_from_a_subfolder_it_counts_paths_from_the_checkout_s_root(mine):
    done = run("python3", str((mine / "try.py").relative_to(ROOT)), folder=mine)
    assert done.stdout.splitlines() == [f"{ROOT} {ROOT} 1"], done.stderr
    done = run("python3", "try.py", folder=mine)
    assert done.returncode == 2 and f"{ROOT / 'try.py'}" in done.stderr


def test_a_script_s_own_modules_come_first_and_a_user_s_pythonpath_last(mine):
    library = mine / "library"
    for package in ("rom", "elsewhere"):
        (library / package).mkdir(parents=True)
        (library / package / "__init__.py").write_text(f"name = {package!r}\n")
    done = run("python3", str((mine / "try.py").relative_to(ROOT)), PYTHONPATH=str(library))
    assert done.stdout.splitlines() == [f"{ROOT} {ROOT} 1"], done.stderr
    done = run("python3", "-c", "import elsewhere; print(elsewhere.name)", PYTHONPATH=str(library))
    assert done.stdout == "elsewhere\n"
    (mine / "control.py").write_text("mine = True\n")
    (mine / "clash.py").write_text("import control, rom; print(control.mine, rom.__file__)\n")
    done = run("python3", str((mine / "clash.py").relative_to(ROOT)))
    assert done.stdout.split()[0] == "True" and str(ROOT / "rom") in done.stdout
