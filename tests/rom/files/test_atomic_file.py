"""Files appear whole or not at all, and nothing is left beside them."""

import errno
import os
from pathlib import Path

import pytest

from rom.files.atomic_file import atomic_file, write_whole


def there(folder: Path) -> dict[str, bytes]:
    return {one.name: one.read_bytes() for one in folder.iterdir()}


@pytest.fixture
def file(tmp_path) -> Path:
    return tmp_path / "model.h5"


def test_until_it_is_whole_the_former_file_is_found_and_afterwards_the_new_one(file):
    file.write_bytes(b"former")
    with atomic_file(file) as beside:
        beside.write_bytes(b"half")
        assert file.read_bytes() == b"former" and beside.parent == file.parent
        beside.write_bytes(b"whole")
    assert there(file.parent) == {"model.h5": b"whole"}


@pytest.mark.parametrize("error", [RuntimeError("no"), KeyboardInterrupt(), OSError(errno.ENOSPC, "no space")])
def test_what_goes_wrong_within_leaves_the_former_file_and_nothing_else(file, error):
    file.write_bytes(b"former")
    with pytest.raises(type(error)), atomic_file(file) as beside:
        beside.write_bytes(b"half")
        raise error
    assert there(file.parent) == {"model.h5": b"former"}


def test_an_error_of_the_disk_names_the_file_that_was_asked_for(file):
    with pytest.raises(OSError) as full, atomic_file(file):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "/somewhere/.else")
    assert full.value.filename == str(file) and full.value.errno == errno.ENOSPC
    nowhere = file.parent / "nowhere" / "model.h5"
    with pytest.raises(FileNotFoundError) as missing:
        write_whole(nowhere, lambda stream: stream.write(b"1"))
    assert missing.value.filename == str(nowhere)
    with pytest.raises(FileNotFoundError), atomic_file(file):
        pass  # nothing was written
    assert there(file.parent) == {}


def test_once_the_first_one_stays_and_others_are_no_error(file):
    write_whole(file, lambda stream: stream.write(b"first"), once=True)
    write_whole(file, lambda stream: stream.write(b"second"), once=True)
    assert there(file.parent) == {"model.h5": b"first"}
    write_whole(file, lambda stream: stream.write(b"third"))
    assert there(file.parent) == {"model.h5": b"third"}


def test_two_writers_at_once_do_not_write_into_one_another_s_file(file):
    with atomic_file(file) as one, atomic_file(file) as other:
        one.write_bytes(b"one")
        other.write_bytes(b"other")
        assert one != other and one.read_bytes() == b"one"
    assert there(file.parent) == {"model.h5": b"one"}  # the last that ends
