"""A drawing as a figure of a report."""

from __future__ import annotations

from dataclasses import dataclass

from reports.labels import Label


@dataclass(frozen=True)
class Drawing:
    """An SVG with its title and its words for who cannot see it."""

    title: Label
    svg: bytes
    words: str
    caption: str = ""
    wide: bool = True

    def as_svg(self) -> bytes:
        """The picture."""
        return self.svg

    def alternative_text(self) -> str:
        """What it shows, in words."""
        return self.words
