"""The C header: compiled without a warning, it gives what Python gives."""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest
from sampled import tabled
from terminal import ran

from rom.export.c_header import export

STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"]
PROGRAM = '#include "finger.h"\nint answer(const double *p, double *o, double *j) { return finger_answer(p, o, j); }\n'
COMPILER = shutil.which("cc") or shutil.which("gcc")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")


@pytest.fixture(scope="module")
def marked():
    """A table that reaches so near that the finger has no answer in some of its cells."""
    return tabled(0.0, nodes=6)


@pytest.fixture(scope="module")
def compiled(marked, tmp_path_factory):
    folder = tmp_path_factory.mktemp("c")
    export(marked, folder / "finger.h")
    (folder / "finger.c").write_text(PROGRAM)
    library = folder / "finger.so"
    command = [COMPILER, *STRICT, "-shared", "-fPIC", "-o", str(library), "finger.c", "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    answer = ctypes.CDLL(str(library)).answer
    doubles = ctypes.POINTER(ctypes.c_double)

    def call(point):
        point = np.ascontiguousarray(point, float)
        out, jacobian = np.empty(5), np.empty((5, len(point)))
        inside = answer(*(array.ctypes.data_as(doubles) for array in (point, out, jacobian)))
        return out, jacobian, bool(inside)

    return call


@needs_compiler
def test_values_and_gradients_are_python_s_to_round_off(marked, compiled):
    random, (lower, upper) = np.random.default_rng(0), marked.limits
    points = lower + random.random((3000, 3)) * (upper - lower)
    special = [[0, 0, 0], [100, 100, 0], [100, 0, 0.031], [50, 50, np.inf], [-1, 50, 0.01], [np.nan, 0, 0.01]]
    special += [[20, 0, 10.0], [20, 0, 0.0311], [20, 0, -0.001]]
    touched, refused = [], []
    for point in [*points, *np.array(special, float)]:
        out, jacobian, inside = compiled(point)
        ours, slopes = marked.value_and_jacobian(point)
        touched.append(ours[3] > 0)
        assert inside == bool(marked.evaluate(point).inside)
        refused.append(not inside)
        scale = np.maximum(np.abs(ours), [0.05, 0.05, 0.05, 15, 0.03])
        assert np.abs(out - ours).max(initial=0, where=~np.isnan(ours)) <= 1e-12 * scale.max()
        assert jacobian == pytest.approx(slopes, rel=1e-9, abs=1e-12 * np.abs(slopes).max() + 1e-12)
    assert 0.2 < np.mean(touched) < 0.8 and any(refused[:3000])


@needs_compiler
def test_the_command_writes_a_header_that_says_what_it_is(table_file, tmp_path):
    done = ran("rom", "export", table_file, tmp_path / "thumb.h")
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "thumb.h").read_text()
    assert "int thumb_answer(const double point[thumb_PARAMETERS]" in text and "F1 [N] from 0 to 100" in text
    assert not any(word in text for word in ("malloc", "calloc", "#include <stdlib.h>"))
    refused = ran("rom", "export", table_file, tmp_path / "2.h")
    assert refused.returncode == 2 and "C identifier" in refused.stderr
