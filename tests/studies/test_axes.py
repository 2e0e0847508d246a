"""Pictures can be read: ticks are plain numbers, and labels hide nothing."""

import matplotlib.pyplot as plt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studies.axes import logarithmic, plain
from studies.labels import extent, label


@given(low=st.floats(1e-9, 1e3), decades=st.floats(0.7, 9.0))
def test_logarithmic_axes_have_at_least_three_ticks_within_their_limits(low, decades):
    figure, axes = plt.subplots()
    high = low * 10**decades
    axes.loglog([low, high], [low, high])
    axes.set(xlim=(low, high), ylim=(low, high))
    logarithmic(axes)
    values = axes.get_xticks()
    plt.close(figure)
    assert 3 <= len(values) <= 11 and all(low <= value <= high for value in values)


@pytest.mark.parametrize(("value", "shown"), [(1000.0, "1,000"), (0.05, "0.05"), (1.0, "1"), (2e-5, "2e-5")])
def test_ticks_are_numbers_as_people_write_them(value, shown):
    assert plain(value) == shown


def test_labels_hide_neither_points_nor_each_other():
    figure, axes = plt.subplots(figsize=(9, 6))
    points = [(1.0 + 0.03 * k, 1.0 + 0.01 * (k % 3)) for k in range(6)] + [(2.0, 2.0), (3.0, 0.5)]
    axes.plot(*zip(*points, strict=True), "o")
    axes.set(xlim=(0, 4), ylim=(0, 3))
    label(axes, points, [f"alternative {k}" for k in range(len(points))])
    figure.draw_without_rendering()
    boxes = [extent(text) for text in axes.texts]
    at = axes.transData.transform(points)
    plt.close(figure)
    assert len(boxes) == len(points)
    assert not any(one.overlaps(other) for k, one in enumerate(boxes) for other in boxes[:k])
    assert not any(box.contains(*point) for box in boxes for point in at)


def test_labels_without_room_are_refused():
    figure, axes = plt.subplots(figsize=(1, 1))
    axes.set(xlim=(0, 1), ylim=(0, 1))
    with pytest.raises(ValueError, match="labels must have room"):
        label(axes, [(0.5, 0.5)], ["a name that is longer than the picture is wide"])
    plt.close(figure)
