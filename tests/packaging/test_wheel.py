"""A wheel brings the compiled part: where it is installed, nothing needs a compiler."""

import subprocess
import sys
from pathlib import Path

from rom.native import levels

ROOT = Path(__file__).resolve().parents[2]
HOLD = """
from control import Finger
from rom import TouchedSegment
import rom
print(Finger(TouchedSegment.load()).hold(1.0, 0.010).status, rom.__file__)
"""


def pip(*words: object) -> None:
    command = [sys.executable, "-m", "pip", "-q", "--disable-pip-version-check", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_a_wheel_holds_a_force_without_a_compiler(tmp_path):
    pip("wheel", "--no-deps", "-w", tmp_path, ROOT)
    (wheel,) = tmp_path.glob("*.whl")
    pip("install", "--no-deps", "--target", tmp_path / "installed", wheel)
    settings = {
        "PYTHONPATH": str(tmp_path / "installed"),
        "PATH": "/nowhere",
        "XDG_CACHE_HOME": str(tmp_path / "cache"),
    }
    done = subprocess.run([sys.executable, "-c", HOLD], cwd=tmp_path, env=settings, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    status, place = done.stdout.split()
    assert status == "converged" and place.startswith(str(tmp_path))
    assert not (tmp_path / "cache").exists()  # nothing was built
    assert len(list((tmp_path / "installed").rglob("*.so"))) == 3 * len(levels())
