"""Files that appear whole or not at all: nothing half written is ever found under a file's name."""

import contextlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from uuid import uuid4


@contextlib.contextmanager
def atomic_file(file: Path, once: bool = False) -> Iterator[Path]:
    """A path beside a file, to be written in the context, which then gets the file's name.

    Args:
        file: the file.
        once: whoever comes first writes it.

    Raises:
        OSError: names the file, not the path beside it.
    """
    beside = file.with_name(f".{file.name}.{uuid4().hex}")
    try:
        yield beside
        with beside.open("rb") as stream:
            os.fsync(stream.fileno())
        if once:
            with contextlib.suppress(FileExistsError):
                os.link(beside, file)
        else:
            os.replace(beside, file)
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(file)) from None
    finally:
        with contextlib.suppress(OSError):  # report the error that stopped the file
            beside.unlink(missing_ok=True)


def write_whole(file: Path, write: Callable[[Any], None], once: bool = False) -> None:
    """Write a file by a function of a binary stream, see `atomic_file`."""
    with atomic_file(file, once) as beside, beside.open("xb") as stream:
        write(stream)


def check_folder(file: Path, option: str = "output") -> None:
    """Refuse a file that could not be written, before there is anything to write."""
    if not file.parent.is_dir():
        raise ValueError(f"{option} must be in a folder that exists, got {file}")


def check_plot(file: Path) -> None:
    """Refuse a picture that could not be written, for its folder or for its format, which the file's ending names."""
    from matplotlib.figure import Figure

    formats = Figure().canvas.get_supported_filetypes()
    if file.suffix.removeprefix(".") not in formats:
        raise ValueError(f"plot must end in one of {', '.join(sorted(formats))}, got {file}")
    check_folder(file, "plot")
