"""Pages written by hand have no avoided words and no sentence that is too long; the check finds both."""

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
