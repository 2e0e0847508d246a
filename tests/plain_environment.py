"""A Python without some packages, for tests: a command runs where their import fails."""

import os
import re
import subprocess
import sys
from collections.abc import Collection
from importlib import import_module
from importlib.metadata import requires

import typer
from terminal import ROOT

from rom.console.packages import REMEDIES

WITHOUT = """
import runpy, sys

class Others:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in absent:
            return None
        found = (finder.find_spec(name, path, target) for finder in finders)
        return next((spec for spec in found if spec is not None), None)

    def find_distributions(self, *words):
        able = (finder for finder in finders if hasattr(finder, "find_distributions"))
        return (one for finder in able for one in finder.find_distributions(*words))

absent = set(sys.argv[1].split(","))
finders, sys.meta_path[:] = list(sys.meta_path), [Others()]
sys.argv = sys.argv[2:]
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
"""

# What typer needs itself is there wherever a command is: newer versions need pydantic.
TYPER = {re.split(r"[^\w-]", one)[0] for one in requires("typer") or [] if "extra ==" not in one}
OPTIONAL = REMEDIES.keys() - TYPER


def run_without(packages: Collection[str], *words: object, **settings: str) -> subprocess.CompletedProcess[str]:
    """Run `python3 -m WORDS` where these packages are not installed."""
    return subprocess.run(
        [sys.executable, "-c", WITHOUT, ",".join(packages), *map(str, words)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env=os.environ | settings,
        timeout=300,
    )


def commands(program: str) -> set[str]:
    """The names of a program's commands."""
    found = typer.main.get_command(import_module(f"{program}.__main__").app)
    return set(found.commands)  # type: ignore[attr-defined]
