"""The C header of a finger of rod elements: compiled without a warning, it answers as Python in the caller's memory."""

import ctypes
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from rom.__main__ import app
from rom.export.c_header import export, header
from rom.files.checked_file import ModelError
from rom.rod.compiled import memory_of
from rom.rod.objects.shapes import Cylinder, Sphere, box, facing_plane
from rom.rod.rod import QUANTITIES
from rom.rod.touched_segment import SHIPPED, TouchedSegment
from tests.rom.rod.outlined import rod_of

STRICT = ["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", "-Wpedantic"]
COMPILER = shutil.which("cc") or shutil.which("gcc")
pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
NUMBERS = 1e-13  # [m, N and what derivatives have]: rounding, as compilers may take sums in another order
# What a program without an operating system has, too; gcc makes `sincos` of `sin` and `cos` where the C library has it.
MEMORY, ROUNDING = {"memcpy", "memset", "memmove"}, {"abs", "fabs", "sqrt", "floor", "fmin", "fmax", "copysign"}
LIBRARY = MEMORY | ROUNDING | {"atan2", "cos", "pow", "sin", "sincos"}
FLAT = """
#define FINGER_IMPLEMENTATION
#include "finger.h"

/* An answer as one row: out, derivatives, errors, whether it is inside, evaluations. */
int touch(int shape, const double *numbers, const double *point, double *wrenches, double *row)
{
    static double memory[finger_MEMORY];
    finger_answer answer;
    fingerfem_object object = finger_plane();
    if (shape == FINGERFEM_SPHERE) object = fingerfem_object_sphere(numbers, numbers[6], numbers + 7);
    if (shape == FINGERFEM_CYLINDER) object = fingerfem_object_cylinder(numbers, numbers + 3, numbers[6], numbers + 7);
    if (shape < 0) object.direction[0] = numbers[0];
    const int inside = finger_touch(&object, point, memory, wrenches, &answer);
    memcpy(row, answer.out, sizeof answer.out);
    memcpy(row + 5, answer.jacobian, sizeof answer.jacobian);
    memcpy(row + 5 * (2 + finger_TENSIONS), answer.errors, sizeof answer.errors);
    row[5 * (2 + finger_TENSIONS) + 3] = answer.evaluations;
    return inside;
}

/* A report as one row: orientation, shortenings, their derivatives, errors. */
int report(const double *point, double *wrenches, double *row)
{
    static double memory[finger_MEMORY];
    finger_answer answer;
    finger_reported reported;
    const fingerfem_object object = finger_plane();
    const int inside = finger_report(&object, point, memory, wrenches, &answer, &reported);
    const int rows = 4 + finger_TENSIONS;
    memcpy(row, reported.orientation, sizeof reported.orientation);
    memcpy(row + 4, reported.shortenings, sizeof reported.shortenings);
    memcpy(row + rows, reported.orientation_jacobian, sizeof reported.orientation_jacobian);
    memcpy(row + rows + 4 * (finger_TENSIONS + 1), reported.shortening_jacobian, sizeof reported.shortening_jacobian);
    row[rows * (2 + finger_TENSIONS)] = reported.orientation_error;
    row[rows * (2 + finger_TENSIONS) + 1] = reported.shortening_error;
    return inside;
}

int place(const double *tensions, const double *wrenches, double *found)
{
    static double memory[finger_MEMORY];
    return finger_place(tensions, wrenches, memory, found, found + 3 * finger_PLATES, found + 12 * finger_PLATES);
}
"""


def compiled(folder: Path, program: str, *options: str, output: str = "program") -> Path:
    """A program of C, built beside a header."""
    (folder / f"{output}.c").write_text(program)
    line = [str(COMPILER), *options, "-o", output, f"{output}.c", "-lm"]
    done = subprocess.run(line, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    return folder / output


def run(program: Path) -> list[float]:
    """The numbers that a program prints."""
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return [float(word) for word in done.stdout.split()]


@pytest.fixture(scope="module")
def two_plates(model):
    """A finger of two segments of other lengths, with a tendon to each plate."""
    scene, lengths = model.rod.scene, [0.04, 0.06]
    geometry = scene["geometry"] | {"segments": lengths}
    tendons = [one | {"segment": 2 - k} for k, one in enumerate(scene["tendons"])]
    rod = model.rod.assembled(scene | {"geometry": geometry, "tendons": tendons})
    return TouchedSegment(rod=rod, obstacle=facing_plane(geometry["side"], (0.0, sum(lengths))))


@pytest.fixture(scope="module")
def heavy(model):
    """The finger of one plate, so heavy that it sags by a tenth of its length."""
    gravity = {"density": 1070.0, "direction": [0.2, 0.9, -0.3], "acceleration": 300.0}
    return TouchedSegment(rod=model.rod.assembled(model.scene | {"gravity": gravity}), obstacle=model.obstacle)


@pytest.fixture(
    scope="module", params=["one plate", "round", "heavy", pytest.param("two plates", marks=pytest.mark.long)]
)
def called(request, model, heavy, two_plates, tmp_path_factory):
    """A model, and the functions of its header."""
    circle = replace(model, rod=rod_of("circle"))
    own = {"one plate": model, "round": circle, "heavy": heavy, "two plates": two_plates}[request.param]
    folder = tmp_path_factory.mktemp("header")
    export(own, folder / "finger.h")
    return own, ctypes.CDLL(str(compiled(folder, FLAT, *STRICT, "-shared", "-fPIC", output="finger.so")))


@pytest.fixture(scope="module")
def alone(model, tmp_path_factory):
    """The folder of the header of the finger of one plate."""
    folder = tmp_path_factory.mktemp("alone")
    export(model, folder / "finger.h")
    return folder


def doubles(array: np.ndarray):
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def touch(
    library, shape: int, numbers: list[float], point: np.ndarray, wrenches: np.ndarray
) -> tuple[np.ndarray, bool]:
    """A row of answers, see FLAT."""
    row, given = np.empty(5 * (1 + len(point)) + 4), [np.array(numbers, float), np.array(point, float)]
    inside = library.touch(shape, *map(doubles, given), doubles(wrenches), doubles(row))
    return row, bool(inside)


def objects(length: float) -> list[tuple[int, list[float], object]]:
    """A sphere and a cylinder beside a finger, as numbers and in Python."""
    centre, direction = (0.95 * length, 0.02, 0.001), (0.1, 1.0, 0.0)
    axis, ends = (0.1, 0.0, 1.0), (-1.0, 1.0)
    ball = Sphere(centre=centre, radius=0.012, direction=direction, distances=ends)
    bar = Cylinder(centre=centre, radius=0.012, axis=axis, direction=direction, distances=ends)
    return [(1, [*centre, 0, 0, 0, 0.012, *direction], ball), (2, [*centre, *axis, 0.012, *direction], bar)]


def assert_same(library, shape: int, numbers: list[float], model: TouchedSegment, points: np.ndarray) -> np.ndarray:
    """That C answers at points, each from rest, as Python does; returns the forces."""
    ours, answer = model.answers(points), model.evaluate(points)
    errors = np.array([answer.error[name] for name in QUANTITIES]).T
    near = NUMBERS * (1 if model.scene.get("gravity") is None else 1000)  # weight is solved for at every evaluation
    apart = 0
    for k, point in enumerate(points):
        wrenches, count = np.zeros(ours.loads.shape[1]), len(point)
        row, inside = touch(library, shape, numbers, point, wrenches)
        out, slopes, off = row[:5], row[5 : 5 * (1 + count)].reshape(5, count), row[5 * (1 + count) :]
        assert inside == answer.inside[k]
        if off[3] != ours.evaluations[k]:  # rounding ends a solve one step earlier
            apart += 1
            np.testing.assert_allclose(out, ours.out[k], rtol=1e-6, atol=1e-9)
            continue
        np.testing.assert_allclose(out, ours.out[k], rtol=near, atol=near)
        np.testing.assert_allclose(wrenches, ours.loads[k], rtol=near, atol=10 * near)
        scale = np.abs(ours.jacobians[k]).max(axis=1, keepdims=True)
        np.testing.assert_allclose(slopes / (scale + 1e-9), ours.jacobians[k] / (scale + 1e-9), atol=100 * near)
        np.testing.assert_allclose(off[:3], errors[k], rtol=100 * near)
    assert apart <= 1 + len(points) // 50
    return ours.out[:, 3]


def before(model: TouchedSegment, count: int, most: float) -> np.ndarray:
    """Points about where an object touches the free finger, shape (count, p); F1 reaches a share of its range."""
    lower, upper = model.limits
    points = lower + np.random.default_rng(1).random((count, len(lower))) * (upper - lower) * [most, 0.3 * most, 1.0]
    touch = model.outputs(points)[:, 4]
    points[:, -1] = np.where(np.isfinite(touch), touch + np.linspace(0.002, -0.004, count), 0.0)
    return points


def test_free_and_before_the_plane_it_answers_as_python_to_rounding(called):
    model, library = called
    points = before(model, 20, 0.4)
    points[::4, -1] = np.inf
    points[1] = 1.1 * model.limits[1]  # outside
    forces = assert_same(library, 0, [0.0], model, points)
    assert (forces[::4] == 0.0).all() and (forces > 0.05).sum() >= 5


def test_before_an_object_of_the_caller_it_answers_as_python_to_rounding(called):
    model, library = called
    for shape, numbers, obstacle in objects(sum(model.scene["geometry"]["segments"])):
        own = TouchedSegment(rod=model.rod, obstacle=obstacle)
        forces = assert_same(library, shape, numbers, own, before(own, 10, 0.2 / len(model.rod.segments) ** 2))
        assert (forces > 0.05).sum() >= 3 and (forces == 0.0).any()


def test_plates_are_where_python_has_them(called):
    model, library = called
    tensions, plates = 0.5 * model.limits[1][:-1], len(model.rod.segments)
    wrenches = np.random.default_rng(3).normal(size=(plates, 6)) * [1, 1, 1, 0.02, 0.02, 0.02]
    found = np.empty(plates * (12 + 6 * (len(tensions) + 6 * plates)))
    for pressed in (wrenches, None):
        ours = model.rod.place(tensions, pressed)
        given = None if pressed is None else doubles(pressed)
        assert library.place(doubles(tensions), given, doubles(found)) == ours.inside
        parts = [ours.centres.ravel(), ours.rotations.ravel(), ours.motions.ravel()]
        np.testing.assert_allclose(found, np.concatenate(parts), rtol=1e-11, atol=NUMBERS)


def test_its_report_is_python_s_before_a_plane(called):
    model, library = called
    points = before(model, 12, 0.3 / len(model.rod.segments))
    report, width = model.report(points), points.shape[1]
    for k, point in enumerate(points):
        row, wrenches = np.empty((3 + width) * (1 + width) + 2), np.zeros(6 * sum(map(len, model.rod.pieces)))
        inside = library.report(doubles(point), doubles(wrenches), doubles(row))
        parts = [report.orientation[k], report.shortenings[k], report.orientation_jacobian[k].ravel()]
        parts += [report.shortening_jacobian[k].ravel(), [report.orientation_error[k], report.shortening_error[k]]]
        np.testing.assert_allclose(row, np.concatenate(parts), rtol=1e-9, atol=1e-11)
        assert bool(inside) == report.inside[k]
    assert (report.shortening_jacobian[:, :, -1] != 0).any()  # some are in contact


def test_a_solve_goes_on_from_the_wrenches_of_the_last_one(called):
    model, library = called
    lower, upper = model.limits
    point = np.where(np.arange(len(lower)) == model.lead, 0.3 * upper, lower)
    point[-1] = 0.5 * model.outputs(point[None])[0, 4]
    wrenches = np.zeros(6 * sum(map(len, model.rod.pieces)))
    first, _ = touch(library, 0, [0.0], point, wrenches)
    again, inside = touch(library, 0, [0.0], point + 1e-6, wrenches)
    assert inside and 0 < again[-1] < first[-1]
    np.testing.assert_allclose(again[:5], first[:5], rtol=1e-3)


def test_an_object_that_is_none_is_no_answer(called):
    model, library = called
    for wrong in (np.nan, np.inf, 0.5):
        row, inside = touch(library, -1, [wrong], model.limits[0], np.zeros(6 * sum(map(len, model.rod.pieces))))
        assert not inside and np.isnan(row[:5]).all() and row[-1] == 0.0


HULL = """
#define FINGER_IMPLEMENTATION
#include "finger.h"
#include <stdio.h>
{arrays}
static double memory[finger_MEMORY], wrenches[finger_LOADS];
static finger_answer answer;
int main(void)
{{
    const double point[] = {{{point}}};
    finger_touch(part, point, memory, wrenches, &answer);
    printf("%.17g %.17g %.17g", answer.out[1], answer.out[3], answer.out[4]);
    return 0;
}}
"""


@pytest.mark.long
def test_a_hull_is_its_numbers_in_python(model, alone):
    from rom.export.numbers import definitions
    from rom.native import LIBRARY

    cube = box(centre=(0.045, 0.03, 0.0), sides=(0.02,) * 3, direction=(0.0, 1.0, 0.0), rotation=(0.2, 0.1, 0.6))
    point = [40.0, 5.0, 0.002]  # deeper, the finger may leave the edge by either side, as rounding has it
    lines, name = definitions(LIBRARY.struct("fingerfem_object", **cube.numbers()), "hull_")
    program = HULL.format(arrays="".join(lines), point=", ".join(map(str, point))).replace("(part,", f"({name},")
    ours = TouchedSegment(rod=model.rod, obstacle=cube).outputs(np.array([point]))[0]
    assert ours[3] > 0.1
    found = run(compiled(alone, program, *STRICT, output="hull"))
    np.testing.assert_allclose(found, ours[[1, 3, 4]], rtol=10 * NUMBERS)


def test_the_example_in_it_runs_within_its_memory(model, alone):
    text = (alone / "finger.h").read_text()
    example = re.search(r"^       #include <math.h>\n.*?^       }\n", text, re.MULTILINE | re.DOTALL)
    assert example is not None
    options = [*STRICT, "-O1", "-fsanitize=address"]
    program = compiled(alone, example[0], *options, output="example")
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    said = re.fullmatch(r"inside 1, tip y ([-\d.]+) mm, contact force ([\d.]+) N\n", done.stdout)
    point = re.search(r"point\[.*\] = \{(.*)\}", example[0])
    assert said is not None and point is not None
    out = model.outputs(np.array([[float(one) for one in point[1].split(",")]]))[0]
    assert float(said[1]) == pytest.approx(1e3 * out[1], abs=6e-4)
    assert float(said[2]) == pytest.approx(out[3], abs=6e-5) and float(said[2]) > 0.1


ANSWERS = """
#include "{one}.h"
#include "{two}.h"
#include <stdio.h>
static double memory[{one}_MEMORY + {two}_MEMORY], wrenches[2][{one}_LOADS + {two}_LOADS];
int main(void)
{{
    const double point[] = {{20.0, 10.0, 0.005}}, direction[] = {{0.0, 1.0, 0.0}}, centre[] = {{0.045, 0.02, 0.0}};
    const fingerfem_object ball = fingerfem_object_sphere(centre, 0.01, direction);
    {one}_answer first;
    {two}_answer second;
    if ({one}_memory() != {one}_MEMORY || {two}_memory() != {two}_MEMORY) return 1;
    {one}_touch(&ball, point, memory, wrenches[0], &first);
    {two}_touch(&ball, point, memory, wrenches[1], &second);
    printf("%.17g %.17g %d %d %.17g", first.out[1], second.out[1], {one}_MEMORY, {two}_MEMORY, {two}_upper[2]);
    return 0;
}}
"""


@pytest.mark.parametrize("together", [True, False], ids=["one unit", "a unit for each"])
def test_two_fingers_live_in_one_program_of_several_units(model, two_plates, tmp_path, together):
    export(model, tmp_path / "thumb.h")
    export(two_plates, tmp_path / "index.h")
    thumb, index = (
        '#define THUMB_IMPLEMENTATION\n#include "thumb.h"\n',
        '#define INDEX_IMPLEMENTATION\n#include "index.h"\n',
    )
    units = {"main.c": ANSWERS.format(one="thumb", two="index")}
    units |= {"both.c": thumb + index} if together else {"thumb.c": thumb, "index.c": index}
    for name, text in units.items():
        (tmp_path / name).write_text(text)
    line = [str(COMPILER), *STRICT, "-o", "program", *units, "-lm"]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    ball = Sphere(centre=(0.045, 0.02, 0.0), radius=0.01, direction=(0.0, 1.0, 0.0))
    tips = [
        TouchedSegment(rod=one.rod, obstacle=ball).outputs(np.array([[20, 10, 0.005]]))[0, 1]
        for one in (model, two_plates)
    ]
    sizes = [len(memory_of(one.touching.chain)) for one in (model, two_plates)]
    np.testing.assert_allclose(run(tmp_path / "program"), [*tips, *sizes, 0.1], rtol=NUMBERS)


def test_it_needs_mathematics_and_copies_of_memory_alone_and_keeps_no_state(alone):
    program = '#define FINGER_IMPLEMENTATION\n#include "finger.h"\n'
    made = compiled(alone, program, *STRICT, "-c", "-fno-pie", output="finger.o")
    lines = subprocess.run(["nm", made], capture_output=True, text=True, check=True).stdout.splitlines()
    kinds = [(line.split()[-2], line.split()[-1]) for line in lines]
    undefined = {name for kind, name in kinds if kind == "U"}
    assert undefined <= LIBRARY, undefined - LIBRARY
    assert not {name for kind, name in kinds if kind in "bBdDC"}
    shown = {name for kind, name in kinds if kind in "TR"}
    assert shown == {f"finger_{one}" for one in ("lower", "upper", "memory", "plane", "place", "touch", "report")}


STACK = """
#include <stdio.h>
#define FINGER_IMPLEMENTATION
#include "finger.h"
enum { SIZE = 1 << 20 };
static double memory[finger_MEMORY], wrenches[finger_LOADS];
static finger_answer answer;
static finger_reported reported;
__attribute__((noinline)) static int painted(int paint)
{
    volatile unsigned char stack[SIZE];
    int left = 0;
    for (int i = 0; i < SIZE && paint; i++) stack[i] = 0xA5;
    while (!paint && left < SIZE && stack[left] == 0xA5) left++;
    return SIZE - left;
}
__attribute__((noinline)) static void ask(double share)
{
    const double direction[] = {0.0, 1.0, 0.0}, centre[] = {0.04, 0.02, 0.0};
    const fingerfem_object ball = fingerfem_object_sphere(centre, 0.01, direction);
    double point[finger_TENSIONS + 1] = {0.0};
    point[0] = share * finger_upper[0];
    memset(wrenches, 0, sizeof wrenches);
    finger_report(&ball, point, memory, wrenches, &answer, &reported);
}
int main(void)
{
    double most = 0.0, force = 0.0;
    for (int k = 0; k < 10; k++) {
        painted(1);
        ask(0.05 * k);
        const int used = painted(0);
        if (used > most) most = used;
        if (answer.out[3] > force) force = answer.out[3];
    }
    printf("%g %g", most, force);
    return 0;
}
"""


@pytest.mark.parametrize("plates", [1, 2])
def test_a_call_takes_no_more_stack_than_it_says(model, two_plates, tmp_path, plates):
    export(model if plates == 1 else two_plates, tmp_path / "finger.h")
    stated = re.search(r"at most (\d+) kB of stack", (tmp_path / "finger.h").read_text())
    program = compiled(tmp_path, STACK, "-std=c11", "-O2", "-Wno-maybe-uninitialized")
    most, force = run(program)
    assert stated is not None and force > 0.1
    assert 5000 < most < 1000 * float(stated[1])


def test_c_plus_plus_includes_its_declarations(alone):
    if not (compiler := shutil.which("g++")):
        pytest.skip("needs a C++ compiler")
    (alone / "finger.cc").write_text('#include "finger.h"\nint size() { return finger_memory(); }\n')
    line = [compiler, "-std=c++17", *STRICT[1:], "-c", "finger.cc"]
    done = subprocess.run(line, cwd=alone, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "", done.stderr


def test_the_command_writes_it_and_refuses_what_it_cannot_have(tmp_path):
    runner, words = CliRunner(), ["export", str(SHIPPED)]
    done = runner.invoke(app, [*words, str(tmp_path / "thumb.h")])
    assert done.exception is None and "int thumb_touch(" in (tmp_path / "thumb.h").read_text()
    done = runner.invoke(app, [*words, str(tmp_path / "other.h"), "--tolerance", "0.01"])
    assert str(done.exception) == "tolerance must be left out for a finger of elements, got 0.01"
    done = runner.invoke(app, [*words, str(tmp_path / "2.h")])
    assert str(done.exception).startswith("name must be a C identifier") and str(done.exception).endswith("got 2")
    assert [one.name for one in tmp_path.iterdir()] == ["thumb.h"]


@pytest.mark.parametrize("name", ["my finger", "2nd", "fingér", "", "a-b", "_finger"])
def test_a_name_that_is_no_identifier_is_refused(model, name):
    with pytest.raises(ModelError, match="name must be a C identifier"):
        header(model, name)
