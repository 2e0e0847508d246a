"""The doctor finds this environment well, and says what is wrong with a worse one."""

import json
import os
import subprocess
import sys

from farm import ROOT

DOCTOR = [sys.executable, "-m", "fingerfem", "doctor"]


def findings(**settings) -> dict[str, dict]:
    done = subprocess.run([*DOCTOR, "--json"], cwd=ROOT, capture_output=True, text=True, env=os.environ | settings)
    answer = json.loads(done.stdout)
    assert done.returncode == (3 if answer["wrong"] else 0)
    return {finding["name"]: finding for finding in answer["findings"]}


def test_the_environment_is_well():
    found = findings()
    assert {"dolfinx", "MUMPS", "mpirun", "locks", "form cache", "C compiler"} < found.keys()
    assert [name for name, finding in found.items() if finding["verdict"] == "wrong"] == []


def test_what_is_missing_is_named_with_its_remedy(tmp_path):
    (tmp_path / "dolfinx.py").write_text("raise ImportError('libdolfinx.so: cannot open shared object file')")
    found = findings(PATH=str(tmp_path), OMP_NUM_THREADS="8", PYTHONPATH=str(tmp_path), DISPLAY="")
    assert found["dolfinx"]["verdict"] == "wrong" and "libdolfinx.so" in found["dolfinx"]["found"]
    assert "python3-dolfinx" in found["dolfinx"]["remedy"]
    assert found["mpirun"]["verdict"] == found["C compiler"]["verdict"] == "wrong"
    assert found["threads"]["verdict"] == found["display"]["verdict"] == "slow"


def test_it_answers_where_the_command_line_s_own_packages_are_missing(tmp_path):
    (tmp_path / "typer.py").write_text("raise ModuleNotFoundError('no typer here')")
    settings = os.environ | {"PYTHONPATH": str(tmp_path)}
    done = subprocess.run(DOCTOR, cwd=ROOT, capture_output=True, text=True, env=settings)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and "python3 -m fingerfem.doctor" in done.stderr
    done = subprocess.run(
        [sys.executable, "-m", "fingerfem.doctor"], cwd=ROOT, capture_output=True, text=True, env=settings
    )
    assert done.returncode == 3 and "wrong  typer        ModuleNotFoundError: no typer here" in done.stdout
