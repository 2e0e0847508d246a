"""Pages and code have no avoided words, too long sentences or docstrings that begin with fragments; all are found."""

import importlib.util
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SPEC = importlib.util.spec_from_file_location("language", ROOT / "docs" / ".site" / "language.py")
assert SPEC is not None and SPEC.loader is not None
language = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(language)


def test_pages_written_by_hand_have_no_complaint():
    assert len(list(language.files(language.BY_HAND))) > 15
    assert list(language.complaints()) == []


def test_avoided_words_are_found_with_their_lines():
    text = "The model knows its box.\nA stationary point is none.\nfound = tell(finger)\n"
    assert [line for line, _ in language.avoided(text)] == [1, 3]


def test_long_sentences_are_found_and_code_and_tables_are_not_read():
    words = "word " * (language.MOST_WORDS + 1)
    page = f"# {words}\n\nShort.\n\nThis is {words.strip()}.\n\n```\n{words}\n```\n\n| {words} |\n"
    assert [line for line, _ in language.too_long(page)] == [5]
    assert not list(language.too_long(f"{words[:60].strip()}. {words[:60].strip()}.\n"))


def test_docstrings_that_begin_with_a_fragment_are_found_and_questions_are_not():
    code = '''"""A module. Where it ends is open."""


class One:
    """Of a class."""

    def what(self):
        """Whether it is 1.5; of what: Howard.

        What follows a blank line.

            How is 0.5 N held?
        """
        return "What it says."  # How it ends
'''
    found = [(line, complaint.split("'")[1]) for line, complaint in language.openings(code)]
    assert found == [(1, "Where"), (5, "Of"), (8, "Whether"), (10, "What")]
