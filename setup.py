"""Wheels bring the compiled part with them, so that the machine that installs one needs no C compiler.

Everything else is in pyproject.toml. An editable install compiles at first use.
"""

import runpy
import shutil
import sys
import sysconfig
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

sys.path.insert(0, str(Path(__file__).parent))
from rom.native import LIBRARY, compiler, levels


class BuildWithLibraries(build_py):
    """Also builds the libraries, where there is a compiler."""

    def run(self) -> None:
        """Copy the packages, without what an earlier build has left, then build beside the copied sources."""
        if not self.editable_mode:
            shutil.rmtree(self.build_lib, ignore_errors=True)
        super().run()
        if self.editable_mode or not compiler():
            return
        control = runpy.run_path("control/native/__init__.py")["CONTROL"]  # the package itself imports NumPy
        for library, package in ((LIBRARY, "rom"), (control, "control")):
            for level in levels():
                library.build(Path(self.build_lib) / package / "native", level)


platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
setup(cmdclass={"build_py": BuildWithLibraries}, options={"bdist_wheel": {"plat_name": platform}} if compiler() else {})
