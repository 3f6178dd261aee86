"""The house style: the only place where colours, line widths and figure sizes are chosen.

The series colours come from Okabe and Ito's palette, which the common kinds of colour blindness keep
apart; each pair also differs in lightness, so that a print in grey can be read.

Shades of a map's cells, from none to the darkest, each with the ink that reads best on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Tone:
    """One colour of the house, on paper and light screens (`light`) and on dark screens (`dark`)."""

    light: str
    dark: str


#: Roles of lines in figures. A figure names roles, never colours.
SERIES: dict[str, Tone] = {
    "gain": Tone("#0072B2", "#56B4E9"),
    "phase": Tone("#D55E00", "#F5A15B"),
    "third": Tone("#00795A", "#3CCFA4"),
    "fourth": Tone("#A8487F", "#DF93BC"),
    "fifth": Tone("#7A6A00", "#E4D34A"),
    "reference": Tone("#5B6673", "#A7B3C0"),
    "measured": Tone("#1B2229", "#E6EBF0"),
    "limit": Tone("#A4161A", "#FF8A80"),
}
#: Roles for lines that are neither of the two controllers, in order of use.
FURTHER_ROLES = ("third", "fourth", "fifth")

#: Surfaces, text and verdicts.
SURFACE: dict[str, Tone] = {
    "page": Tone("#FFFFFF", "#14181D"),
    "panel": Tone("#F4F6F8", "#1C2229"),
    "ink": Tone("#1B2229", "#E6EBF0"),
    "quiet": Tone("#55606C", "#A3AFBB"),
    "rule": Tone("#D3D9DF", "#37414B"),
    "grid": Tone("#E6EAEE", "#2A323B"),
    "band": Tone("#F6F0DC", "#332F1D"),
    "link": Tone("#005A8F", "#7CC4F2"),
    "pass": Tone("#00664A", "#4FD1A5"),
    "fail": Tone("#A4161A", "#FF8A80"),
    "error": Tone("#6B2C91", "#D3A4F0"),
    "on-verdict": Tone("#FFFFFF", "#14181D"),
}

LINE_WIDTH_PX = 1.4
#: Lines that come first are wider, so that one lying exactly under another still shows at its edges.
WIDER = {"gain": 1.5}
DASHES = ("solid", "dash", "dot", "dashdot")
#: Points kept of one line: an envelope of the lowest and highest value in each of half as many stretches.
POINTS_ON_SCREEN = 2400
POINTS_ON_PAPER = 1200
#: A figure on paper: one column of an A4 page.
PAPER_WIDTH_MM = 84.0
PAPER_HEIGHT_MM = 52.0
PAPER_WIDE_MM = (172.0, 42.0)

#: What Matplotlib is given, in points.
PAPER: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 6.6,
    "mathtext.fontset": "dejavusans",
    "axes.edgecolor": SURFACE["quiet"].light,
    "axes.labelcolor": SURFACE["ink"].light,
    "axes.linewidth": 0.5,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "grid.color": SURFACE["grid"].light,
    "grid.linewidth": 0.5,
    "lines.linewidth": 0.7,
    "lines.solid_joinstyle": "round",
    "xtick.color": SURFACE["quiet"].light,
    "ytick.color": SURFACE["quiet"].light,
    "xtick.labelcolor": SURFACE["ink"].light,
    "ytick.labelcolor": SURFACE["ink"].light,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.minor.size": 0.0,
    "ytick.minor.size": 0.0,
    "legend.frameon": False,
    "legend.fontsize": 6.4,
    "svg.fonttype": "path",
    "svg.hashsalt": "eaxle-hil",  # the same recording gives the same bytes
    "path.simplify": False,  # lines come decimated
}


def css_variables(theme: str) -> str:
    """Declarations of every colour as a custom property; `theme` is 'light' or 'dark'."""
    series = {f"series-{role}": tone for role, tone in SERIES.items()}
    return " ".join(f"--{name}: {getattr(tone, theme)};" for name, tone in (SURFACE | series).items())


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
    tone = SERIES["gain"] if negative else SURFACE["fail"]
    full, none = (_channels(getattr(one, theme)) for one in (tone, SURFACE["panel"]))
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
