"""The cache of compiled forms survives a killed compilation."""

from fingerfem import compilation


def test_what_a_killed_compilation_left_is_cleared_and_what_is_whole_stays(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    folder = compilation.cache_folder()
    folder.mkdir()
    for name in ("whole.c", "whole.c.cached", "half.c"):
        (folder / name).touch()
    assert compilation.one_at_a_time(lambda: sorted(file.name for file in folder.glob("*.c*"))) == [
        "whole.c",
        "whole.c.cached",
    ]
