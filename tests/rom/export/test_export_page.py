"""The programs of docs/howto/export.md compile without a warning, and answer as Python does."""

import ctypes
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from rom.export.c_header import export
from rom.rod.objects.shapes import Sphere
from rom.rod.touched_segment import TouchedSegment

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "howto" / "export.md").read_text()
pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a compiler of C")


@pytest.fixture(scope="module")
def printed(model, tmp_path_factory) -> tuple[Path, dict[str, list[float]]]:
    """The folder of the page's programs, and the numbers that each prints."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "out").mkdir()
    export(model, folder / "out" / "finger.h")
    for name, text in re.findall(r'^```\w+ title="(.*?)"\n(.*?)^```$', PAGE, re.DOTALL | re.MULTILINE):
        (folder / name).write_text(text)
    numbers = {}
    for line in re.findall(r"^docker/run ((?:cc|out/) ?.*)$", PAGE, re.MULTILINE):
        done = subprocess.run(line, shell=True, cwd=folder, capture_output=True, text=True)
        assert done.returncode == 0 and done.stderr == "", done.stderr
        numbers[line] = [float(word) for word in re.findall(r"(?<![\w+])\d+\.?\d*", done.stdout)]
    return folder, numbers


def test_the_robot_presses_a_ball_as_in_python(model, printed):
    ball = Sphere(centre=(0.045, 0.022, 0.0), radius=0.01, direction=(0, 1, 0), distances=(-1.0, 1.0))
    touched = TouchedSegment(rod=model.rod, obstacle=ball)
    numbers = printed[1]["out/robot"]
    points = [[tension, 0.0, 0.0] for tension in (10.0, 20.0, 30.0, 40.0)]
    forces = [touched.evaluate(point).contact_force for point in points]
    assert numbers[1:16:4] == pytest.approx(forces, abs=6e-4)  # [N], as they are rounded
    assert numbers[-1] == pytest.approx(touched.jacobian(points[-1])[3, 0], abs=6e-5)


def test_the_shared_library_answers_as_python(model, printed):
    folder, _ = printed
    point, out = np.array([20.0, 0.0, 0.010]), np.empty(5)
    answer = model.evaluate(point)
    library = ctypes.CDLL(str(folder / "out" / "press.so"))
    doubles = [array.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for array in (point, out)]
    assert library.press(*doubles) == 1
    assert out == pytest.approx([*answer.tip, answer.contact_force, answer.touch_distance], rel=1e-10, abs=1e-15)
