"""The cache of compiled forms survives a killed compilation."""

from fingerfem import compilation


def test_what_a_killed_compilation_left_is_cleared_and_what_is_whole_stays(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    folder = compilation.cache_folder()
    folder.mkdir()
    for name in ("whole.c", "whole.c.cached", "half.c"):
        (folder / name).touch()
    sources = lambda: sorted(file.name for file in folder.glob("*.c*"))  # noqa: E731
    assert compilation.once(sources, "scene") == ["whole.c", "whole.c.cached"]
    (folder / "half.c").touch()
    assert compilation.once(sources, "scene") == ["whole.c", "whole.c.cached"]
    assert (folder / "scene.whole").exists()
