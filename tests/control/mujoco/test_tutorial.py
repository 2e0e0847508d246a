import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mujoco")
ROOT = Path(__file__).resolve().parents[3]


def test_the_tutorial_lifts_its_box():
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "mujoco-tutorial.md").read_text(), re.DOTALL)
    assert len([line for line in code.splitlines() if line]) <= 40
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    status, lifted, trained = done.stdout.splitlines()
    assert status.count("converged") == 3
    assert 65 <= int(lifted.split()[2]) <= 72
    assert trained == "as trained"
