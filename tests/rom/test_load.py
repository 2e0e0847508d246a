"""One way to read a model file of any kind."""

import pytest
from terminal import ROOT

import rom
from rom.bundled import FINGERS
from rom.files.checked_file import ModelError


def test_a_file_is_read_by_its_kind_and_none_is_the_bundled_finger(table_file):
    assert type(rom.load(table_file)) is rom.SeparatedModel
    point = [30.0, 0.0, 0.010]
    bundled, named = rom.load(), rom.load(str(ROOT / "rom" / "finger.h5"))
    assert type(bundled) is type(named) is rom.TouchedSegment
    assert bundled.evaluate(point).contact_force == named.evaluate(point).contact_force


def test_a_tolerance_leaves_out_terms_of_a_separated_model_and_is_refused_for_a_finger(table_file):
    whole, fewer = (rom.load(table_file, tolerance) for tolerance in (0.0, 3e-2))
    assert sum(fewer.terms.values()) < sum(whole.terms.values())
    with pytest.raises(ValueError, match=r"tolerance must be left out for a finger of elements, got 0\.01"):
        rom.load(tolerance=0.01)


def test_other_files_are_refused_by_name(tmp_path):
    file = tmp_path / "none.h5"
    with pytest.raises(ModelError, match=r"none\.h5"):
        rom.load(file)
    with pytest.raises(ModelError, match="scene"):
        rom.load(ROOT / "scenes" / "draft.toml")


def test_bundled_fingers_are_read_by_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in FINGERS:
        model = rom.load(name)
        length = model.rod.scene["geometry"]["segments"][0]
        assert model.rod.rest[0] < length and model.evaluate([0.0] * len(model.rod.names), d=length).inside
    assert rom.load("finger").scene == rom.load().scene
    with pytest.raises(ModelError, match="hexagonal"):
        rom.load("hexagonal")
