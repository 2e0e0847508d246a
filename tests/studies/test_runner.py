"""Studies go on where they were, and no page outlives its study."""

from pathlib import Path

import pytest

from studies import parts, sections
from studies.declared import STUDIES, Study


def test_no_page_was_written_by_an_older_version_of_its_study():
    assert sections.stale() == []


def test_every_generated_page_says_its_commit_and_date():
    for study in STUDIES:
        text = sections.section_of(study)
        assert "commit " in text.split("---")[-1] and "unknown" not in text.split("---")[-1], study


def test_a_page_has_the_words_of_its_template():
    """A key that was written by hand would hide a template that has changed."""
    for study in STUDIES:
        section = sections.section_of(study)
        if sections.AGED in section:
            continue
        lines = (parts.ROOT / "studies" / study / "page.md.j2").read_text().splitlines()
        prose = [line.strip() for line in lines if line.strip() and not {"{", "}"} & set(line)]
        assert len(prose) > 2 and [line for line in prose if line not in section] == [], study


@pytest.fixture
def study(tmp_path, monkeypatch):
    """A study of one part."""
    folder = tmp_path / "studies" / "lengths"
    folder.mkdir(parents=True)
    (folder / "own.py").write_text("LENGTH = 1.0  # [m]\n")
    (folder / "page.md.j2").write_text("# Lengths\n{% for row in rows %}\n{{ row.length | number }}\n{% endfor %}\n")
    (tmp_path / "docs").mkdir()
    for module in (parts, sections):
        monkeypatch.setattr(module, "ROOT", tmp_path)
        monkeypatch.setattr(module, "STUDIES", {"lengths": Study("lengths", {"rows": "own"})})
    monkeypatch.setattr(sections, "DOCS", tmp_path / "docs")
    return folder


def run_of(folder: Path) -> parts.Run:
    place = parts.place("lengths/rows", folder.parents[1] / "out")
    place.folder.mkdir(parents=True, exist_ok=True)
    return place


def test_rows_that_were_measured_are_kept_until_the_study_changes(study):
    measured = []

    def row(length: float) -> dict:
        if length == 2.0 and len(measured) < 2:
            measured.append("interrupted")
            raise KeyboardInterrupt
        measured.append(length)
        return {"length": length}

    with pytest.raises(KeyboardInterrupt):
        [run_of(study).once(f"{length}", row, length) for length in (1.0, 2.0)]
    rows = [run_of(study).once(f"{length}", row, length) for length in (1.0, 2.0)]
    assert rows == [{"length": 1.0}, {"length": 2.0}] and measured == [1.0, "interrupted", 2.0]
    (study / "page.md.j2").write_text("# Lengths in metres\n")
    run_of(study).once("1.0", row, 1.0)
    assert measured == [1.0, "interrupted", 2.0]  # a page that shows them otherwise measures nothing anew
    (study / "own.py").write_text("LENGTH = 1.0  # in metres\n")
    run_of(study).once("1.0", row, 1.0)
    assert measured == [1.0, "interrupted", 2.0, 1.0]


def test_a_page_is_stale_once_its_study_or_its_template_changes(study, monkeypatch):
    out = study.parents[1] / "out"
    with pytest.raises(parts.Unmeasured, match="lengths/rows must be measured first"):
        sections.write_page("lengths", out)
    assert sections.stale()
    monkeypatch.setenv(parts.COMMIT, "0123abc")
    parts.finished(run_of(study), [{"length": 0.0123456}], 60.0)
    sections.write_page("lengths", out)
    text = (sections.DOCS / "lengths.md").read_text()
    assert text.startswith("<!-- begin lengths -->\n# Lengths\n0.0123\n") and "commit 0123abc" in text
    assert sections.stale() == []
    for file in ("own.py", "page.md.j2"):
        before = (study / file).read_text()
        (study / file).write_text(before + "\n")
        assert sections.stale() == ["docs/lengths.md is not of this studies/lengths: make docs"]
        (study / file).write_text(before)
    assert sections.stale() == []


def test_what_the_packages_measured_before_they_changed_is_not_taken(study, tmp_path):
    before = run_of(study).folder
    (tmp_path / "rom").mkdir()
    (tmp_path / "rom" / "fit.py").write_text("DEGREE = 3\n")
    after = run_of(study).folder
    (tmp_path / "rom" / "fit.py").write_text("DEGREE = 4\n")
    assert len({before, after, run_of(study).folder}) == 3


def test_a_template_that_names_what_was_not_measured_is_an_error(study):
    (study / "page.md.j2").write_text("{{ rows[0].width }}\n")
    parts.finished(run_of(study), [{"length": 1.0}], 1.0)
    with pytest.raises(Exception, match="width"):
        sections.write_page("lengths", study.parents[1] / "out")


def test_a_part_is_measured_by_its_module_and_what_that_imports_of_its_study():
    folder = parts.ROOT / "studies" / "rods"
    names = {file.name for file in parts.imported(folder / "objects.py", folder)}
    assert {"objects.py", "compared.py", "random_objects.py", "full_order.py"} <= names
    assert not names & {"accuracy.py", "page.py"}
    assert parts.measuring_hash("rods/objects") != parts.measuring_hash("rods/accuracy")


def test_every_declared_part_has_its_function_and_its_template():
    for study, declared in STUDIES.items():
        assert (parts.ROOT / "studies" / study / "page.md.j2").exists() and set(declared.elsewhere) <= set(
            declared.parts
        )
        for part in set(declared.parts) - set(declared.elsewhere):  # the others need MuJoCo
            assert callable(parts.function_of(f"{study}/{part}"))


def test_an_import_that_moves_leaves_a_page_fresh_and_any_other_line_does_not(study):
    code = study / "own.py"
    code.write_text("from rom.one import (\n    a,\n)\n\nLENGTH = 1.0\n")
    before = sections.page_hash("lengths")
    code.write_text("from rom.other.one import (\n    b,\n)\n\nLENGTH = 1.0\n")
    assert sections.page_hash("lengths") == before
    code.write_text("from rom.other.one import (\n    b,\n)\n\nLENGTH = 2.0\n")
    assert sections.page_hash("lengths") != before


def test_numbers_are_written_for_people():
    assert [sections.percent(share) for share in (0.5, 0.0123, 1.0)] == ["50 %", "1.2 %", "100 %"]
    assert [sections.number(value) for value in (12345, 0.0123456, None)] == ["12,345", "0.0123", "-"]
    assert [sections.number(value, 2) for value in (1413.0, 14.13, 0.1413, 1e6)] == ["1,413", "14", "0.14", "1e+06"]
    errors = {"median": 0.00033, "p95": 0.0029, "max": 0.07, "count": 3}
    assert sections.spread(errors) == "0.033, 0.29, 7 %" and sections.spread({"count": 0}) == "-"
    assert sections.spread({"median": 2.9, "p95": 117.0, "max": 1200.0}, "µm") == "2.9, 117, 1,200 µm"


def test_a_page_of_an_older_study_is_stale_unless_it_says_so(study, tmp_path):
    page = tmp_path / "docs" / "lengths.md"
    page.write_text("# Lengths\n")
    assert sections.stale() == ["docs/lengths.md is not of this studies/lengths: make docs"]
    page.write_text(f"<!-- begin lengths -->\n# Lengths\n\n{sections.AGED}\n<!-- lengths 0 -->\n")
    assert sections.stale() == []


def test_a_section_is_replaced_in_its_page_and_the_others_stay(study, monkeypatch):
    page = sections.DOCS / "sizes.md"
    monkeypatch.setattr(sections, "STUDIES", {"lengths": Study("sizes", {"rows": "own"})})
    widths = "<!-- begin widths -->\nwidths\n<!-- widths 0 -->\n"
    page.write_text(f"# Sizes\n\n{widths}\n<!-- begin lengths -->\nold\n<!-- lengths 0 -->\n")
    assert sections.page_of("lengths") == page and sections.section_of("lengths").splitlines()[1] == "old"
    (study / "page.md.j2").write_text("## Lengths\n")
    monkeypatch.setattr(
        sections, "results", lambda *_: ({}, {"one": {"commit": "a", "date": "b", "cores": 1, "seconds": 6}})
    )
    for _ in range(2):  # the second time as the first
        sections.write_page("lengths", study.parents[1] / "out")
        text = page.read_text()
        assert text.startswith(f"# Sizes\n\n{widths}\n<!-- begin lengths -->\n## Lengths\n") and "old" not in text
        assert text.count("<!-- begin lengths -->") == 1 and sections.stale() == []
