from __future__ import annotations

import pytest

from reports import style


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("level", range(style.DARKEST + 1))
def test_every_shade_can_be_read(level: int, theme: style.Theme) -> None:
    background, ink = style.colours(level, theme)
    assert style.contrast(background, ink) >= 4.5


@pytest.mark.parametrize("level", range(1, style.DARKEST + 1))
def test_negative_shades_are_of_another_colour_and_can_be_read(level: int) -> None:
    background, ink = style.colours(level, "light", negative=True)
    assert style.contrast(background, ink) >= 4.5
    assert background != style.colours(level, "light")[0]


def test_contrast_is_that_of_the_guidelines() -> None:
    assert style.contrast("#000000", "#FFFFFF") == pytest.approx(21.0)
    assert style.contrast("#777777", "#FFFFFF") == pytest.approx(4.48, abs=0.005)  # their own example


def test_shades_go_from_none_to_the_darkest() -> None:
    assert [style.level(s) for s in (0.0, 0.04, 0.5, 1.0)] == [0, 0, 5, 10]
    assert len({style.colours(level, "light")[0] for level in range(11)}) == 11
