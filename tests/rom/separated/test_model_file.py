"""The model file: readable without this project, and refused in one line when it is not what it should be."""

import json
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from rom import SeparatedModel
from rom.files.checked_file import ModelError

ROOT = Path(__file__).resolve().parents[3]


def test_a_saved_model_is_the_model_bit_for_bit(table, tmp_path):
    table.save(tmp_path / "copy.h5")
    copy = SeparatedModel.load(tmp_path / "copy.h5")
    points = np.random.default_rng(0).random((200, 3)) * [100, 100, 0.03] + [0, 0, 0.001]
    ours, theirs = (model.evaluate(points) for model in (table, copy))
    assert np.array_equal(ours.tip, theirs.tip) and np.array_equal(ours.contact_force, theirs.contact_force)
    assert all(np.array_equal(ours.error[name], theirs.error[name]) for name in ours.error)
    assert copy.parameters == table.parameters and copy.accuracy == table.accuracy
    assert list(tmp_path.iterdir()) == [tmp_path / "copy.h5"]


def test_every_dataset_has_a_unit_and_every_form_names_its_axes(table_file):
    with h5py.File(table_file) as file:
        datasets = []
        file.visititems(lambda name, item: datasets.append(name) if isinstance(item, h5py.Dataset) else None)
        assert datasets and all("unit" in file[name].attrs for name in datasets)
        for form, axes in (("free", ["F1", "F2"]), ("contact", ["F1", "F2", "s"])):
            assert json.loads(file[form].attrs["axes"]) == axes
        assert json.loads(file["contact"].attrs["components"]) == ["x", "y", "z", "contact_force"]
        assert all(name in file.attrs for name in ("scene", "provenance", "accuracy", "parameters", "lead"))


def test_the_reader_in_the_documentation_reads_it_with_h5py_and_numpy_alone(table, tmp_path):
    table.save(tmp_path / "finger.h5")
    text = (ROOT / "docs" / "format.md").read_text()
    program = re.search(r"```python\n(.*?)```", text, re.S).group(1)
    assert len([line for line in program.splitlines() if line.strip()]) <= 22
    assert re.findall(r"^(?:import|from) (.*)$", program, re.M) == ["h5py, json, numpy as np"]
    points = [
        [40.0, 30.0, 0.025],
        [82.5, 11.2, 0.0256],
        [60.0, 25.0, 0.012],
        [30.0, 80.0, 0.0054],
        [99.0, 20.0, 0.0271],
    ]
    calls = "".join(f"print(*answer('finger.h5', {point[:-1]}, {point[-1]}))\n" for point in points)
    (tmp_path / "reader.py").write_text(program + "\n" + calls)
    done = subprocess.run([sys.executable, "reader.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for line, point in zip(done.stdout.splitlines(), points, strict=True):
        answer = table.evaluate(point)
        ours = [*answer.tip, float(answer.contact_force), float(answer.touch_distance)]
        assert [float(word) for word in line.split()] == pytest.approx(ours, rel=1e-9, abs=1e-12)


def refused(file: Path, *rules: str) -> None:
    with pytest.raises(ModelError, match=re.escape(str(file))) as caught:
        SeparatedModel.load(file)
    assert "\n" not in str(caught.value)
    assert all(rule in str(caught.value) for rule in rules)


def test_files_that_are_no_models_are_refused_in_one_line(tmp_path):
    (tmp_path / "text.h5").write_text("not HDF5")
    (tmp_path / "empty.h5").write_bytes(b"")
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["data"] = np.arange(5)
    for name in ("text.h5", "empty.h5", "foreign.h5", "nowhere.h5"):
        refused(tmp_path / name)
    refused(tmp_path)  # a folder


def test_another_format_is_refused_by_its_number(tmp_path, table_file):
    file = tmp_path / "older.h5"
    file.write_bytes((table_file).read_bytes().replace(b"format 2,", b"format 1,", 1))
    refused(file, "must be a model of format 2, got format 1; build it again")


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_truncated_files_are_refused(tmp_path, table_file, share):
    whole = (table_file).read_bytes()
    file = tmp_path / "short.h5"
    file.write_bytes(whole[: int(share * len(whole))])
    refused(file)


@pytest.mark.parametrize(
    "change",
    [
        lambda file: file["contact/modes"].__setitem__((0, 0), 1.0),
        lambda file: file["answered"].__setitem__((0, 0, 0), 1 - file["answered"][0, 0, 0]),
        lambda file: file.__delitem__("free/functions_0"),
        lambda file: file["error"].attrs.__setitem__("margin", "0.1"),
        lambda file: file.attrs.__setitem__("parameters", file.attrs["parameters"].replace("100.0", "200.0")),
    ],
    ids=["number", "cells", "dataset", "attribute", "limits"],
)
def test_altered_files_are_refused(tmp_path, table_file, change):
    file = tmp_path / "altered.h5"
    file.write_bytes((table_file).read_bytes())
    with h5py.File(file, "r+") as stored:
        change(stored)
    refused(file, "damaged")


@pytest.mark.parametrize("seed", range(20))
def test_flipped_bits_never_give_a_wrong_answer(tmp_path, table_file, table, seed):
    """Either the file is refused, or nothing that counts was changed."""
    whole = bytearray((table_file).read_bytes())
    random = np.random.default_rng(seed)
    for _ in range(3):
        whole[random.integers(len(whole))] ^= 1 << int(random.integers(8))
    file = tmp_path / "flipped.h5"
    file.write_bytes(whole)
    try:
        model = SeparatedModel.load(file)
    except ModelError:
        return
    point = [60.0, 25.0, 0.012]
    assert np.array_equal(model.evaluate(point).tip, table.evaluate(point).tip)
