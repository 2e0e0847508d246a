"""C files as one text: names of files' own do not clash, and what nothing needs is left out."""

import shutil
import subprocess
from pathlib import Path

import pytest

from rom.export.amalgamation import Sources
from rom.export.c_text import declarations
from rom.files.checked_file import ModelError

COMPILER = shutil.which("cc") or shutil.which("gcc")
HEADER = """/* What both share. */
#ifndef SHARED_H
#define SHARED_H
#include <stdint.h>

enum { MOST = 3, SIDE = 1 << 2 }; /* limits */
typedef struct {
    double size[MOST], turn; /* a member that is a function elsewhere */
    int32_t count;
} part;
typedef double row __attribute__((vector_size(8 * 2), aligned(8)));

/* The size of a part. */
double size_of(const part *one);
double area_of(const part *one);
double unused(const part *one, void (*ask)(void));
#endif
"""
ONE = """/* Sizes. */
#define _POSIX_C_SOURCE 199309L
#include <time.h>
#include "shared.h"

#define NEAR 1e-3 /* a name that the other file has
                     too */
#if defined(WIDER)
#define FACTOR 3
#else
#define FACTOR 2
#endif
enum { SECOND = 1 };
static const double table[MOST] = {1.0, NEAR, 3.0}, step = 5.0;

/* "turn" of this file. */
__attribute__((always_inline)) static inline double turn(const part *one) { return one->turn * FACTOR; }

double size_of(const part *one)
{
    double sum = 0.0;
    for (int k = 0; k < MOST; k++) sum += one->size[k] * table[k];
    return sum + turn(one) / step * SECOND;
}

double unused(const part *one, void (*ask)(void))
{
    struct timespec now;
    ask();
    return clock_gettime(CLOCK_MONOTONIC, &now) + one->turn;
}
"""
TWO = """#include "shared.h"
#define NEAR 10.0
enum { SECOND = 2 };
typedef struct {
    double last;
} corner;
static const double step = 1.0;

static double turn(corner one) { return one.last * SECOND * step; }

double area_of(const part *one) { return NEAR * size_of(one) + turn((corner){.last = one->turn}); }
"""
MAIN = """
#include <stdio.h>
int main(void)
{
    const my_part one = {.size = {1.0, 2.0, 3.0}, .turn = 5.0, .count = 1};
    printf("%.15g", my_area_of(&one));
    return 0;
}
"""


@pytest.fixture
def sources(tmp_path) -> Sources:
    for name, text in (("shared.h", HEADER), ("one.c", ONE), ("two.c", TWO)):
        (tmp_path / name).write_text(text)
    return Sources.of([tmp_path / "one.c", tmp_path / "two.c"])


def test_declarations_are_separated_with_the_names_that_they_declare():
    found = declarations(HEADER[HEADER.index("enum") : HEADER.rindex("#endif")])
    names = [{"MOST", "SIDE"}, {"part"}, {"row"}, {"size_of"}, {"area_of"}, {"unused"}]
    assert [one.names for one in found] == names
    assert [one.prototype for one in found] == [False] * 3 + [True] * 3
    assert found[0].text.endswith("/* limits */") and found[3].text.lstrip().startswith("/* The size")


@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
def test_two_files_with_the_same_names_become_one_that_computes_the_same(sources, tmp_path):
    text = "#include <stdint.h>\n" + sources.text("area_of part", "my_") + MAIN
    (tmp_path / "all.c").write_text(text)
    line = [str(COMPILER), "-std=c11", "-Wall", "-Wextra", "-Werror", "-o", "all", "all.c"]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    size = 1.0 + 2.0 * 1e-3 + 3.0 * 3.0 + 5.0 * 2 / 5.0
    printed = subprocess.run([tmp_path / "all"], capture_output=True, text=True).stdout
    assert float(printed) == pytest.approx(10.0 * size + 5.0 * 2, rel=1e-13)


def test_what_is_not_needed_is_left_out_and_functions_are_static(sources):
    text = sources.text("area_of", "my_")
    assert not any(word in text for word in ("my_unused", "time", "#include", "_POSIX", "my_row", "SHARED_H"))
    assert "static double my_size_of(const my_part *one);" in text and "#define my_one_c_FACTOR 3" in text
    assert "corner" not in sources.text("size_of", "my_")


def test_a_declaration_that_is_taken_out_keeps_its_name(sources):
    text, others = sources.taken_out(["part"])
    assert text.startswith("typedef struct {") and "double size[MOST]" in text
    assert "const part *one" in others.text("area_of", "my_")


def test_headers_that_declare_the_same_name_are_refused(sources, tmp_path):
    (tmp_path / "other.h").write_text("enum { MOST = 4 };\n")
    (tmp_path / "three.c").write_text('#include "other.h"\nint three(void) { return MOST; }\n')
    both = Sources.of([*(Path(tmp_path / name) for name in ("one.c", "two.c", "three.c"))])
    with pytest.raises(ModelError, match=r"names of headers must differ, got MOST of other\.h twice"):
        both.text("area_of", "my_")
