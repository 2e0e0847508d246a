"""Forms compiled without optimisation: of a tangent of Nitsche's method gcc makes 80 s otherwise."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from dolfinx import jit


@contextmanager
def unoptimised() -> Iterator[None]:
    usual, flags = jit.get_options, {"cffi_extra_compile_args": ["-O0", "-g0"]}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(jit, "get_options", lambda options=None: usual((options or {}) | flags))
        yield
