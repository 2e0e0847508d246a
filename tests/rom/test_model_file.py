"""The model file: readable without this project, and refused in one line when it is not what it should be."""

import hashlib
import re
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from rom import Surrogate
from rom.checked_file import BLOCK, ModelError
from rom.model_file import FORMAT, KIND

ROOT = Path(__file__).resolve().parents[2]


def test_a_saved_model_is_the_model_bit_for_bit(surrogate, tmp_path):
    surrogate.save(tmp_path / "copy.h5")
    copy = Surrogate.load(tmp_path / "copy.h5")
    points = np.random.default_rng(0).random((200, 3)) * [100, 100, 0.03] + [0, 0, 0.001]
    ours, theirs = (model.evaluate(points) for model in (surrogate, copy))
    assert np.array_equal(ours.tip, theirs.tip) and np.array_equal(ours.contact_force, theirs.contact_force)
    for name in ours.error:
        assert np.all(ours.error[name] <= theirs.error[name] * (1 + 1e-12))  # rounded up
        assert ours.error[name] == pytest.approx(theirs.error[name], rel=0.02)
    assert copy.parameters == surrogate.parameters and copy.accuracy == surrogate.accuracy
    assert list(tmp_path.iterdir()) == [tmp_path / "copy.h5"]


def test_every_dataset_has_a_unit_and_every_form_names_its_axes(trained):
    with h5py.File(trained / "finger.h5") as file:
        datasets = []
        file.visititems(lambda name, item: datasets.append(name) if isinstance(item, h5py.Dataset) else None)
        assert datasets and all("unit" in file[name].attrs for name in datasets)
        for form, axes in (
            ("free", [("F1", "N"), ("F2", "N")]),
            ("contact/regime_0", [("F1", "N"), ("F2", "N"), ("s", "-")]),
        ):
            found = [tuple(file[form][f"nodes_{a}"].attrs[key] for key in ("axis", "unit")) for a in range(len(axes))]
            assert found == axes
        assert file["contact/regime_0/modes"].attrs["components"].startswith("x, y, z, contact_force")
        assert all(name in file.attrs for name in ("scene", "provenance", "accuracy", "parameters", "format"))


def test_the_reader_in_the_documentation_reads_it_with_h5py_and_numpy_alone(surrogate, tmp_path):
    surrogate.save(tmp_path / "finger.h5")
    text = (ROOT / "docs" / "format.md").read_text()
    program = re.search(r"```python\n(.*?)```", text, re.S).group(1)
    assert len([line for line in program.splitlines() if line.strip()]) <= 22
    assert re.findall(r"^(?:import|from) (.*)$", program, re.M) == ["h5py, numpy as np"]
    points = [[40.0, 30.0, 0.025], [82.5, 11.2, 0.0256], [60.0, 25.0, 0.012], [30.0, 80.0, 0.004], [99.0, 20.0, 0.0021]]
    calls = "".join(f"print(*answer('finger.h5', {point[:-1]}, {point[-1]}))\n" for point in points)
    (tmp_path / "reader.py").write_text(program + "\n" + calls)
    done = subprocess.run([sys.executable, "reader.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for line, point in zip(done.stdout.splitlines(), points, strict=True):
        answer = surrogate.evaluate(point)
        ours = [*answer.tip, float(answer.contact_force), float(answer.touch_distance)]
        assert [float(word) for word in line.split()] == pytest.approx(ours, rel=1e-9, abs=1e-12)


def refused(file: Path, *rules: str) -> None:
    with pytest.raises(ModelError, match=re.escape(str(file))) as caught:
        Surrogate.load(file)
    assert "\n" not in str(caught.value)
    assert all(rule in str(caught.value) for rule in rules)


def test_files_that_are_no_models_are_refused_in_one_line(tmp_path, trained):
    (tmp_path / "text.h5").write_text("not HDF5")
    (tmp_path / "empty.h5").write_bytes(b"")
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["data"] = np.arange(5)
    for name in ("text.h5", "empty.h5", "foreign.h5", "nowhere.h5"):
        refused(tmp_path / name)
    refused(trained)  # a folder


def test_a_newer_format_is_refused_by_its_number(tmp_path, trained):
    file = tmp_path / "newer.h5"
    file.write_bytes((trained / "finger.h5").read_bytes().replace(b"format 4,", b"format 5,", 1))
    refused(file, "must be a model of format 4, got format 5")


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_truncated_files_are_refused(tmp_path, trained, share):
    whole = (trained / "finger.h5").read_bytes()
    file = tmp_path / "short.h5"
    file.write_bytes(whole[: int(share * len(whole))])
    refused(file)


@pytest.mark.parametrize(
    "change",
    [
        lambda file: file["contact/regime_0/modes"].__setitem__((0, 0), 1.0),
        lambda file: file["contact/map"].__setitem__((0, 0, 0), 1 - file["contact/map"][0, 0, 0]),
        lambda file: file.__delitem__("free/values_0"),
        lambda file: file["contact"].attrs.__setitem__("soft", 0.1),
        lambda file: file.attrs.__setitem__("parameters", file.attrs["parameters"].replace("100.0", "200.0")),
    ],
    ids=["number", "map", "dataset", "attribute", "limits"],
)
def test_altered_files_are_refused(tmp_path, trained, change):
    file = tmp_path / "altered.h5"
    file.write_bytes((trained / "finger.h5").read_bytes())
    with h5py.File(file, "r+") as stored:
        change(stored)
    refused(file, "damaged")


@pytest.mark.parametrize("seed", range(20))
def test_flipped_bits_never_give_a_wrong_answer(tmp_path, trained, surrogate, seed):
    """Either the file is refused, or nothing that counts was changed."""
    whole = bytearray((trained / "finger.h5").read_bytes())
    random = np.random.default_rng(seed)
    for _ in range(3):
        whole[random.integers(len(whole))] ^= 1 << int(random.integers(8))
    file = tmp_path / "flipped.h5"
    file.write_bytes(whole)
    try:
        model = Surrogate.load(file)
    except ModelError:
        return
    point = [60.0, 25.0, 0.012]
    assert np.array_equal(model.evaluate(point).tip, surrogate.evaluate(point).tip)


def test_other_functions_than_hermite_s_are_refused_in_one_line(trained, tmp_path):
    damaged = tmp_path / "linear.h5"
    shutil.copy(trained / "finger.h5", damaged)
    with h5py.File(damaged, "r+") as file:
        file["free"].attrs["functions"] = "linear"
    contents = damaged.read_bytes()
    line = f"{KIND}, format {FORMAT}, sha256 {hashlib.sha256(contents[BLOCK:]).hexdigest()}\n".encode()
    damaged.write_bytes(line.ljust(BLOCK, b"\0") + contents[BLOCK:])
    with pytest.raises(ModelError, match=r"^.*linear\.h5: must have Hermite functions, got linear: build it anew$"):
        Surrogate.load(damaged)
