"""Studies go on where they were, and no page outlives its study."""

from pathlib import Path

import pytest

from studies import runner


def test_no_page_was_written_by_an_older_version_of_its_study():
    assert runner.stale() == []


def test_every_generated_page_says_its_commit_and_date():
    for study in runner.STUDIES:
        text = runner.section_of(study)
        assert "commit " in text.split("---")[-1] and "unknown" not in text.split("---")[-1], study


def test_a_page_has_the_words_of_its_template():
    """A key that was written by hand would hide a template that has changed."""
    for study in runner.STUDIES:
        section = runner.section_of(study)
        if runner.AGED in section:
            continue
        lines = (runner.ROOT / "studies" / study / "page.md.j2").read_text().splitlines()
        prose = [line.strip() for line in lines if line.strip() and not {"{", "}"} & set(line)]
        assert len(prose) > 2 and [line for line in prose if line not in section] == [], study


@pytest.fixture
def study(tmp_path, monkeypatch):
    """A study of two parts, of which one is interrupted the first time."""
    folder = tmp_path / "studies" / "lengths"
    folder.mkdir(parents=True)
    (folder / "study.py").write_text("PARTS = {}\n")
    (folder / "page.md.j2").write_text("# Lengths\n{% for row in rows %}\n{{ row.length | number }}\n{% endfor %}\n")
    (tmp_path / "docs").mkdir()
    monkeypatch.setattr(runner, "ROOT", tmp_path)
    monkeypatch.setattr(runner, "DOCS", tmp_path / "docs")
    monkeypatch.setattr(runner, "STUDIES", ("lengths",))
    return folder


def run_of(folder: Path) -> runner.Run:
    place = runner.place("lengths/rows", folder.parents[1] / "out", quick=False)
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
    (study / "study.py").write_text("PARTS = {}  # in millimetres\n")
    run_of(study).once("1.0", row, 1.0)
    assert measured == [1.0, "interrupted", 2.0, 1.0]


def test_a_page_is_stale_once_its_study_or_its_template_changes(study, monkeypatch):
    monkeypatch.setattr(runner, "parts", lambda name, quick: {"lengths/rows": None})
    out = study.parents[1] / "out"
    with pytest.raises(runner.Unmeasured, match="lengths/rows must be measured first"):
        runner.write_page("lengths", out)
    assert runner.stale()
    monkeypatch.setenv(runner.COMMIT, "0123abc")
    runner.finished(run_of(study), [{"length": 0.0123456}], 60.0)
    runner.write_page("lengths", out)
    text = (runner.DOCS / "lengths.md").read_text()
    assert (
        text.startswith("<!-- begin lengths -->\n# Lengths\n0.0123\n")
        and "commit 0123abc" in text
        and "rows 1.0" in text
    )
    assert runner.stale() == []
    for file in ("study.py", "page.md.j2"):
        before = (study / file).read_text()
        (study / file).write_text(before + "\n")
        assert runner.stale() == ["docs/lengths.md is not of this studies/lengths: make docs"]
        (study / file).write_text(before)
    assert runner.stale() == []


def test_what_the_packages_measured_before_they_changed_is_not_taken(study, tmp_path):
    before = run_of(study).folder
    (tmp_path / "rom").mkdir()
    (tmp_path / "rom" / "fit.py").write_text("DEGREE = 3\n")
    after = run_of(study).folder
    (tmp_path / "rom" / "fit.py").write_text("DEGREE = 4\n")
    assert len({before, after, run_of(study).folder}) == 3


def test_a_template_that_names_what_was_not_measured_is_an_error(study, monkeypatch):
    monkeypatch.setattr(runner, "parts", lambda name, quick: {"lengths/rows": None})
    (study / "page.md.j2").write_text("{{ rows[0].width }}\n")
    runner.finished(run_of(study), [{"length": 1.0}], 1.0)
    with pytest.raises(Exception, match="width"):
        runner.write_page("lengths", study.parents[1] / "out")


def test_the_folders_that_parts_measure_with_are_there():
    """A part without its folder would keep numbers of code that has changed."""
    for study in runner.STUDIES:
        for part, names in runner.folders(study).items():
            assert f"{study}/{part}" in runner.parts(study, quick=False)
            assert all((runner.ROOT / "studies" / study / name).is_dir() for name in names), (part, names)


def test_an_edit_of_one_folder_leaves_parts_that_do_not_measure_with_it(study, monkeypatch):
    monkeypatch.setattr(runner, "folders", lambda _: {"rows": ("own",), "others": ()})
    for name in ("own", "foreign"):
        (study / name).mkdir()
        (study / name / "code.py").write_text("")
    before = {part: runner.measuring_hash(f"lengths/{part}") for part in ("rows", "others", "unlisted")}
    (study / "own" / "code.py").write_text("LENGTH = 1.0  # [m]\n")
    changed = {part for part, known in before.items() if runner.measuring_hash(f"lengths/{part}") != known}
    assert changed == {"rows", "unlisted"}


def test_a_part_is_measured_by_its_module_and_what_that_imports_of_its_study():
    folder = runner.ROOT / "studies" / "rods"
    names = {file.name for file in runner.imported(folder / "robustness.py", folder)}
    assert {"robustness.py", "scattered_objects.py", "full_order.py"} <= names
    assert not names & {"lengths.py", "study.py", "page.py"}
    assert runner.measuring_hash("rods/robustness") != runner.measuring_hash("rods/speed")


def test_an_import_that_moves_leaves_a_page_fresh_and_any_other_line_does_not(study):
    code = study / "own.py"
    code.write_text("from rom.one import (\n    a,\n)\n\nLENGTH = 1.0\n")
    before = runner.page_hash("lengths")
    code.write_text("from rom.other.one import (\n    b,\n)\n\nLENGTH = 1.0\n")
    assert runner.page_hash("lengths") == before
    code.write_text("from rom.other.one import (\n    b,\n)\n\nLENGTH = 2.0\n")
    assert runner.page_hash("lengths") != before


def test_numbers_are_written_for_people():
    assert [runner.percent(share) for share in (0.5, 0.0123, 1.0)] == ["50 %", "1.2 %", "100 %"]
    assert [runner.number(value) for value in (12345, 0.0123456, None)] == ["12,345", "0.0123", "-"]
    assert [runner.number(value, 2) for value in (1413.0, 14.13, 0.1413, 1e6)] == ["1,413", "14", "0.14", "1e+06"]
    assert runner.over({"seconds": 3.0}, "seconds", {"seconds": 2.0}) == "1.50"


def test_a_page_of_an_older_study_is_stale_unless_it_says_so(study, tmp_path):
    page = tmp_path / "docs" / "lengths.md"
    page.write_text("# Lengths\n")
    assert runner.stale() == ["docs/lengths.md is not of this studies/lengths: make docs"]
    page.write_text(f"<!-- begin lengths -->\n# Lengths\n\n{runner.AGED}\n<!-- lengths 0 -->\n")
    assert runner.stale() == []


def test_a_section_is_replaced_in_its_page_and_the_others_stay(study, monkeypatch):
    page = runner.DOCS / "sizes.md"
    monkeypatch.setattr(runner, "PAGES", {"sizes": ("widths", "lengths")})
    widths = "<!-- begin widths -->\nwidths\n<!-- widths 0 -->\n"
    page.write_text(f"# Sizes\n\n{widths}\n<!-- begin lengths -->\nold\n<!-- lengths 0 -->\n")
    assert runner.page_of("lengths") == page and runner.section_of("lengths").splitlines()[1] == "old"
    (study / "page.md.j2").write_text("## Lengths\n")
    monkeypatch.setattr(
        runner, "results", lambda *_: ({}, {"one": {"commit": "a", "date": "b", "cores": 1, "seconds": 6}})
    )
    for _ in range(2):  # the second time as the first
        runner.write_page("lengths", study.parents[1] / "out")
        text = page.read_text()
        assert text.startswith(f"# Sizes\n\n{widths}\n<!-- begin lengths -->\n## Lengths\n") and "old" not in text
        assert text.count("<!-- begin lengths -->") == 1 and runner.stale() == []
