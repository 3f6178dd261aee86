"""Shades of a map's cells, from none to the darkest, each with the ink that reads best on it."""

from __future__ import annotations

from typing import Literal

from reports import style

Theme = Literal["light", "dark"]

#: How many shades there are beside none: colours between them no one tells apart.
DARKEST = 10
_SHARE = 0.85  # of the colour of failures, in the darkest
_INKS = ("#000000", "#FFFFFF")  # of any grey one of them stands out by 4.5 to 1 (WCAG 2.2, 1.4.3)


def level(shade: float) -> int:
    """The shade, from 0 (none) to DARKEST, of a value from 0 to 1."""
    return round(DARKEST * shade)


def colours(of_level: int, theme: Theme, *, negative: bool = False) -> tuple[str, str]:
    """Background and ink of a shade: red, or blue where the sign is negative."""
    tone = style.SERIES["gain"] if negative else style.SURFACE["fail"]
    full, none = (_channels(getattr(one, theme)) for one in (tone, style.SURFACE["panel"]))
    share = _SHARE * of_level / DARKEST
    mixed = tuple(round(share * f + (1 - share) * n) for f, n in zip(full, none, strict=True))
    background = "#{:02X}{:02X}{:02X}".format(*mixed)
    return background, max(_INKS, key=lambda ink: contrast(ink, background))


def css_classes(theme: Theme) -> str:
    """A rule for each shade: classes shade-0 to shade-10, and below-0 to below-10 of negative values."""
    rules = []
    for name, negative in (("shade", False), ("below", True)):
        for of_level in range(DARKEST + 1):
            background, ink = colours(of_level, theme, negative=negative)
            rules.append(f".{name}-{of_level} {{ background: {background}; color: {ink}; }}")
    return " ".join(rules)


def contrast(one: str, other: str) -> float:
    """Contrast ratio of two colours such as '#A4161A', from 1 to 21 (WCAG 2.2)."""
    darker, lighter = sorted(_luminance(colour) for colour in (one, other))
    return (lighter + 0.05) / (darker + 0.05)


def _luminance(colour: str) -> float:
    linear = [
        c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
        for c in (value / 255 for value in _channels(colour))
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _channels(colour: str) -> tuple[int, int, int]:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
