"""Files that appear whole or not at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any
from uuid import uuid4


def write_whole(file: Path, write: Callable[[Any], None], once: bool = False) -> None:
    """Write beside and rename; nothing half written is ever found under the name.

    Once: whoever comes first writes it.
    """
    beside = file.with_name(f".{file.name}.{uuid4().hex}")
    try:
        with beside.open("xb") as stream:
            write(stream)
            stream.flush()
            os.fsync(stream.fileno())
        if once:
            with contextlib.suppress(FileExistsError):
                os.link(beside, file)
        else:
            os.replace(beside, file)
    finally:
        beside.unlink(missing_ok=True)
