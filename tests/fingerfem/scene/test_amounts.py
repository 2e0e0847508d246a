"""Times and shares as people write them: what is read is what was written, and the rest is refused by name."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingerfem.scene.amounts import UNITS, percentage, seconds, share

SPACES = st.sampled_from(["", " ", "  "])


@given(st.integers(1, 10**6), st.sampled_from(list(UNITS)), SPACES)
def test_a_time_is_its_number_times_its_unit(number, unit, space):
    assert seconds("budget", f"{number}{space}{unit}") == number * UNITS[unit]
    assert seconds("budget", f"0.{number}{unit}") == float(f"0.{number}") * UNITS[unit]


def test_the_same_time_in_other_units_is_the_same():
    assert seconds("t", "2h") == seconds("t", "120 min") == seconds("t", "7200s") == 7200
    assert seconds("t", ".5 min") == 30


@given(st.floats(1e-4, 99.9).map(lambda value: f"{value:.6f}"), SPACES)
def test_a_share_is_a_hundredth_of_its_percentage(text, space):
    assert percentage("until", f"{space}{text}{space}%{space}") == pytest.approx(float(text) / 100)
    assert share("until", f"{text}%") == percentage("until", f"{text} %")
    assert share("until", text) == float(text)  # a plain number is a share already


@pytest.mark.parametrize("text", ["", "90", "-1s", "0s", "0.0 h", "1d", "1 m", "1s 2s", "1e3s", "s", "nan s", 90, None])
def test_what_is_no_time_is_refused_in_one_line_with_its_value(text):
    with pytest.raises(ValueError) as refused:
        seconds("budget", text)
    assert str(refused.value) == f"budget must be a time such as 90s, 30min or 2h, got {text!r}"


@pytest.mark.parametrize("text", ["1", "0 %", "100%", "-1 %", "1 percent", "%", "1 %%", "inf %", 0.01, None])
def test_what_is_no_share_is_refused_in_one_line_with_its_value(text):
    with pytest.raises(ValueError) as refused:
        percentage("until", text)
    assert str(refused.value) == f'until must be a share such as "1 %", above 0 and below 100 %, got {text!r}'
