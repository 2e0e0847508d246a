"""Both cores of the machine that measures."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

CORES = 2


def on_cores(function: Callable[..., Any], calls: Sequence[tuple]) -> list[Any]:
    """Results of a function for the arguments of every call, each on one core."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        return [one.result() for one in [pool.submit(function, *call) for call in calls]]
