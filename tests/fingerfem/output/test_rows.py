"""Files of options are refused by their endings, before anything is solved."""

from pathlib import Path

import pytest

from fingerfem.output.rows import check_ending


def test_a_file_of_another_format_is_refused_with_its_option_and_a_missing_or_right_one_is_not():
    check_ending("picture", None, ".png")
    check_ending("picture", Path("finger.PNG"), ".png")
    for name in ("finger.jpg", "finger"):
        with pytest.raises(ValueError, match=rf"picture must end in \.png, got {name}$"):
            check_ending("picture", Path(name), ".png")
