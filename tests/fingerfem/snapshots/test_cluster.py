"""The scripts for clusters, on one machine, with stand-ins for srun and apptainer."""

import os
import re
import subprocess

import pytest
from farm import ROOT, assert_same

SRUN = """#!/usr/bin/env bash
while [[ $1 == --* ]]; do shift; done
for task in 0 1; do SLURM_PROCID=$task "$@" & done
wait -n; first=$?; wait -n; exit $((first + $?))
"""
APPTAINER = """#!/usr/bin/env bash
[ "$1" = exec ] && [ "$2 $4" = "--bind --pwd" ] && [ -e "$6" ] || exit 9
cd "$5"; shift 6; exec "$@"
"""


@pytest.mark.long
def test_the_slurm_script_trains_a_set(scene, undisturbed, tmp_path):
    for name, text in (("srun", SRUN), ("apptainer", APPTAINER)):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    (tmp_path / "image.sif").touch()
    settings = os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}", "FINGERFEM_IMAGE": str(tmp_path / "image.sif")}
    line = ["bash", "docker/cluster/slurm.sh", scene, tmp_path / "set"]
    done = subprocess.run(line, cwd=ROOT, env=settings, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "set", undisturbed)
    again = subprocess.run(
        line, cwd=ROOT, env=settings | {"FINGERFEM_IMAGE": "none.sif"}, capture_output=True, text=True
    )
    assert again.returncode == 2 and again.stderr == "FINGERFEM_IMAGE must name an Apptainer image, got none.sif\n"


@pytest.mark.long
def test_the_multinode_script_trains_a_set_on_the_hosts_it_is_given(scene, undisturbed, tmp_path):
    (tmp_path / "hosts").write_text("localhost slots=2\n")
    line = ["docker/cluster/multinode.sh", tmp_path / "hosts", scene, tmp_path / "set"]
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert re.search(r"\b(\d+) of \1 lines", done.stderr)
    assert_same(tmp_path / "set", undisturbed)
