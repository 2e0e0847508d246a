"""The cache of compiled forms survives a killed compilation."""

from pathlib import Path

from mpi4py import MPI

from fingerfem import compilation, load_scene

SCENES = Path(__file__).resolve().parents[2] / "scenes"


def test_what_a_killed_compilation_left_is_cleared_and_what_is_whole_stays(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    scene, folder = load_scene(SCENES / "draft.toml"), compilation.cache_folder()
    folder.mkdir(parents=True)
    for _ in range(2):  # the second time, all that the scene needs was compiled before
        for name in ("whole.c", "whole.c.cached", "half.c", "other-half.c.cached"):
            (folder / name).touch()
        with compilation.turn(scene, "model", MPI.COMM_SELF):
            assert sorted(file.name for file in folder.glob("*.c*")) == ["whole.c", "whole.c.cached"]


def test_a_build_that_failed_is_not_taken_for_whole(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    scene, folder = load_scene(SCENES / "draft.toml"), compilation.cache_folder()
    for failing in (True, False):
        try:
            with compilation.turn(scene, "model", MPI.COMM_SELF):
                if failing:
                    raise RuntimeError("no compiler")
        except RuntimeError:
            assert failing
        assert len(list(folder.glob("*-model"))) == (not failing)
