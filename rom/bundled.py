"""The fingers that come with the package, by name: files of trained elements (`make model`, `make silicone`)."""

from pathlib import Path

FINGERS = {
    "finger": "the paper's finger: square, 10 mm x 50 mm, two tendons",
    "round": "Dragon Skin 30, round, 20 mm x 80 mm, four tendons, with weight: it hangs",
    "square": "the same rubber, square, 20 mm x 80 mm, four tendons, with weight: it hangs",
}


def file_of(model: str | Path | None) -> Path:
    """The file of a model: of the bundled finger of that name, or a path; the paper's finger if it is None."""
    name = "finger" if model is None else model
    return Path(__file__).with_name(f"{name}.h5") if name in FINGERS else Path(name)
