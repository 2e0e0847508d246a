"""The cache of compiled forms: any number of processes, killed at any moment, and no form compiled twice or in vain.

Processes that end well say `whole` and how many forms they have compiled; the others of them found these whole.
"""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh
from farm import ROOT
from mpi4py import MPI

from fingerfem.discretisation import form_cache

# A form and an expression by number, on a mesh of one cell; the C compiler's calls are counted by FFCx's own function.
SMALL = """
import sys
import numpy as np, ufl
from dolfinx import fem, mesh
from ffcx.codegeneration import jit
from mpi4py import MPI
from fingerfem.discretisation import form_cache

form_cache.NOTICE, form_cache.PATIENCE = map(float, sys.argv[2:4])
compiled, compiler = [], jit._compile_objects
jit._compile_objects = lambda *args, **options: compiled.append(args[3]) or compiler(*args, **options)
box = mesh.create_unit_cube(eval(sys.argv[4]), 2, 1, 1)
print("ready", flush=True)
sys.stdin.readline()
u = fem.Function(fem.functionspace(box, ("Lagrange", 1)))
for i in range(int(sys.argv[1])):
    found = box.comm.allreduce(fem.assemble_scalar(form_cache.form((i + 2 + u) * ufl.dx)))
    assert abs(found - i - 2) < 1e-12, found
    values = form_cache.expression((i + 2) * (1 + u), np.array([[0.5, 0.5, 0.5]])).eval(box, np.zeros(1, np.int32))
    assert np.allclose(values, i + 2), values
print(f"whole {len(compiled)}")
"""


class Jobs:
    """Processes that wait for each other before they ask for forms of one cache."""

    def __init__(self, cache: Path):
        self.settings = os.environ | {"XDG_CACHE_HOME": str(cache)}
        self.forms = cache / "fingerfem" / "forms"

    def begin(self, forms: int, ranks: int = 1, notice=60.0, patience=600.0, **settings: str) -> subprocess.Popen:
        comm = "MPI.COMM_SELF" if ranks == 1 else "MPI.COMM_WORLD"
        line = [sys.executable, "-c", SMALL, str(forms), str(notice), str(patience), comm]
        job = subprocess.Popen(
            line if ranks == 1 else ["mpirun", "-n", str(ranks), *line],
            cwd=ROOT,
            env=self.settings | settings,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        for _ in range(ranks):
            assert job.stdout.readline() == "ready\n", job.communicate()[1]
        return job

    def go(self, *jobs: subprocess.Popen) -> None:
        for job in jobs:
            job.stdin.write("go\n")
            job.stdin.flush()

    def end(self, *jobs: subprocess.Popen) -> int:
        """Number of forms that jobs have compiled."""
        compiled = 0
        for job in jobs:
            said, errors = job.communicate(timeout=300)
            assert job.returncode == 0 and not errors, errors
            compiled += sum(int(line.split()[1]) for line in said.splitlines())
        return compiled

    def private(self) -> list[Path]:
        return list(self.forms.glob("*.*-*"))

    def whole(self) -> int:
        return len([folder for folder in self.forms.iterdir() if folder.is_dir() and "." not in folder.name])

    def slow_compiler(self) -> str:
        """So slow that what is done while it runs is done in time."""
        script = self.settings["XDG_CACHE_HOME"] + "/slow-gcc"
        Path(script).write_text('#!/bin/sh\nsleep 1\nexec gcc "$@"\n')
        Path(script).chmod(0o755)
        return script

    def wait_for_source(self) -> None:
        """Until the C compiler has something to read."""
        deadline = time.monotonic() + 60
        while not any(source.stat().st_size for source in self.forms.glob("*.*-*/*.c")):
            assert time.monotonic() < deadline
            time.sleep(0.001)


@pytest.fixture
def jobs(tmp_path) -> Jobs:
    return Jobs(tmp_path)


def test_an_expression_with_a_derivative_is_compiled_once_whatever_the_process_made_before(jobs, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", jobs.settings["XDG_CACHE_HOME"])
    box = mesh.create_unit_cube(MPI.COMM_SELF, 1, 1, 1)
    u = fem.Function(fem.functionspace(box, ("Lagrange", 1)))
    for _ in range(2):
        x = ufl.variable(1 + u)
        twice = form_cache.expression(ufl.diff(x**2, x), np.array([[0.5, 0.5, 0.5]]))
        assert np.allclose(twice.eval(box, np.zeros(1, np.int32)), 2)
    assert jobs.whole() == 1


@pytest.mark.long
def test_jobs_that_start_together_on_a_cold_cache_compile_every_form_once_and_on_a_warm_one_none(jobs):
    for compiled in (6, 0):
        together = [jobs.begin(3), jobs.begin(2), jobs.begin(1, ranks=2)]
        jobs.go(*together)
        assert jobs.end(*together) == compiled
        assert jobs.whole() == 6 and not jobs.private()
    more = jobs.begin(4)  # a cache that is half warm
    jobs.go(more)
    assert jobs.end(more) == 2


@pytest.mark.long
def test_jobs_that_are_killed_at_random_moments_hold_up_nobody(jobs):
    chance = random.Random(2018)
    survivors, victims = [jobs.begin(4) for _ in range(2)], [jobs.begin(4) for _ in range(4)]
    jobs.go(*victims, *survivors)
    for victim in victims:
        time.sleep(chance.uniform(0, 0.5))
        os.kill(victim.pid, signal.SIGKILL)  # the process alone: its compiler writes on
        victim.communicate()
    assert jobs.end(*survivors) <= 8
    assert jobs.whole() == 8
    late = jobs.begin(4)
    jobs.go(late)
    assert jobs.end(late) == 0


@pytest.mark.long
def test_what_a_killed_compilation_has_left_is_removed_when_it_is_old_and_never_used(jobs):
    killed = jobs.begin(1, CC=jobs.slow_compiler())
    jobs.go(killed)
    jobs.wait_for_source()
    os.killpg(killed.pid, signal.SIGKILL)
    killed.communicate()
    (left,), there = jobs.private(), jobs.whole()
    first = jobs.begin(1)
    jobs.go(first)
    assert jobs.end(first) == 2 - there and jobs.private() == [left]
    os.utime(left, (0, 0))
    second = jobs.begin(2)
    jobs.go(second)
    assert jobs.end(second) == 2 and not jobs.private()


@pytest.mark.long
def test_who_waits_for_a_stopped_process_says_so_and_then_compiles_for_itself(jobs):
    stopped = jobs.begin(1, CC=jobs.slow_compiler())
    jobs.go(stopped)
    jobs.wait_for_source()
    os.kill(stopped.pid, signal.SIGSTOP)
    try:
        other = jobs.begin(1, notice=0.5, patience=1.5)
        jobs.go(other)
        said, errors = other.communicate(timeout=120)
    finally:
        os.kill(stopped.pid, signal.SIGCONT)
    assert other.returncode == 0 and said == "whole 2\n"
    (line,) = errors.splitlines()
    assert line.startswith("waiting for ") and f"-{stopped.pid} to compile a form" in line
    assert jobs.end(stopped) in (1, 2)  # the one it was at, and the other unless it was made meanwhile
    assert jobs.whole() == 2 and not jobs.private()


@pytest.mark.long
def test_a_cache_that_is_removed_while_a_form_compiles_is_begun_once_more(jobs):
    job = jobs.begin(1, CC=jobs.slow_compiler())
    jobs.go(job)
    jobs.wait_for_source()
    jobs.forms.rename(jobs.forms.with_name("removed"))
    jobs.forms.mkdir()
    assert jobs.end(job) == 3
    assert jobs.whole() == 2 and not jobs.private()


@pytest.mark.parametrize("ranks", [1, 2])
def test_without_a_compiler_every_rank_raises_one_line_and_nothing_is_left(jobs, ranks):
    job = jobs.begin(1, ranks, CC="/nowhere/gcc", LDSHARED="/nowhere/gcc -shared")
    jobs.go(job)
    errors = job.communicate(timeout=60)[1]
    assert job.returncode != 0
    lines = [line for line in errors.splitlines() if line.startswith("OSError")]
    assert len(lines) == ranks and all("forms must compile, got CompileError" in line for line in lines)
    assert jobs.whole() == 0 and not jobs.private()


def test_commands_without_a_compiler_say_so_in_one_line(scene, tmp_path):
    settings = os.environ | {"XDG_CACHE_HOME": str(tmp_path), "CC": "/nowhere/gcc"}
    line = [sys.executable, "-m", "fingerfem", "solve", str(scene), "F1=10", "--json"]
    done = subprocess.run(line, cwd=ROOT, env=settings, capture_output=True, text=True)
    assert done.returncode == 2 and done.stdout == ""
    (said,) = done.stderr.splitlines()
    assert "forms must compile" in said and "/nowhere/gcc" in said


@pytest.mark.long
def test_commands_at_once_on_a_cold_cache_solve_though_one_of_them_is_killed(tmp_path):
    text = (ROOT / "scenes" / "draft.toml").read_text().replace("cells = [20, 5]", "cells = [10, 5]")
    free = tmp_path / "free.toml"
    free.write_text(text[: text.index("[obstacle]")] + text[text.index("[mesh]") :])
    line = [sys.executable, "-m", "fingerfem", "solve", str(free), "F1=10", "--json"]
    options = {"cwd": ROOT, "env": os.environ | {"XDG_CACHE_HOME": str(tmp_path)}, "text": True}
    options |= {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    killed, *others = [subprocess.Popen(line, **options) for _ in range(3)]
    forms = tmp_path / "fingerfem" / "forms"
    while len(list(forms.glob("*"))) < 4:
        assert killed.poll() is None
        time.sleep(0.001)
    killed.kill()
    killed.communicate()
    tips = []
    for job in others:
        said, errors = job.communicate(timeout=300)
        assert job.returncode == 0, errors
        tips.append(json.loads(said)["tip"])
    assert tips[0] == tips[1]
