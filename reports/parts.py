"""Reports made of parts, sections of text, tables, maps (shaded tables) and figures, on screen and on paper.

One file on screen that asks no network for anything, with interactive figures; PDF/A-2a and PDF/UA-1 on
paper, from the same `Page`.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from importlib import resources
from typing import Any, Literal, Protocol

from reports import style
from reports.figure import Figure
from reports.labels import Label
from reports.pdf import _font_directory, _known_characters, _spelled_out
from reports.plotly_figure import json_in_script, plotly_figure, plotly_script
from reports.svg_figure import svg_figure


@dataclass(frozen=True)
class Table:
    """Rows of text under a head; columns from `numbers_from` to before `words_from` are numbers.

    `links` are addresses for the first field of each row, relative to the page; '' for none. Paper has none.
    """

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers_from: int = 1
    words_from: int = 99
    links: tuple[str, ...] = ()


@dataclass(frozen=True)
class Cell:
    """One field of a map: its text, how dark it is from 0 (noise) to 1, and whether it is negative."""

    text: str
    shade: float
    negative: bool = False

    @property
    def level(self) -> int:
        """Its shade in steps that can be distinguished."""
        return style.level(self.shade)


@dataclass(frozen=True)
class Map:
    """A shaded table."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, tuple[Cell, ...]], ...]


class Picture(Protocol):
    """What is drawn already."""

    @property
    def title(self) -> Label:
        """Above it."""

    @property
    def caption(self) -> str:
        """Below it."""

    @property
    def wide(self) -> bool:
        """Whether it takes a whole line of text."""

    def as_svg(self) -> bytes:
        """The picture."""

    def alternative_text(self) -> str:
        """What it shows, in words."""


@dataclass(frozen=True)
class Part:
    """A section of the report."""

    id: str
    title: str
    text: str
    tables: tuple[Table, ...] = ()
    maps: tuple[Map, ...] = ()
    figures: tuple[Figure | Picture, ...] = ()

    @cached_property
    def drawn(self) -> dict[str, Any]:
        """What templates are given; pictures are drawn once for screen and paper."""
        return _as_data(self)


def paired(figures: Iterable[Figure]) -> tuple[Figure, ...]:
    """Figures stand in pairs; one that is left over takes the whole width."""
    found = tuple(figures)
    if sum(not figure.wide for figure in found) % 2 == 0:
        return found
    return (*found[:-1], replace(found[-1], wide=True))


@dataclass(frozen=True)
class Page:
    """A whole report: `kind` says what it is a report of, `headline` and `lead` what came out.

    `mark` stands at the head and at the foot: when it was made, by what, from what. `first` stands right
    below the verdict: a table of values beside their limits, and the figure that shows why.
    """

    kind: str
    title: str
    headline: str
    tone: Literal["pass", "fail", "error", "quiet"]
    lead: str
    notes: tuple[str, ...]
    parts: tuple[Part, ...]
    mark: str = ""
    first: Part | None = None


def documents(page: Page) -> dict[str, bytes]:
    """The page in both forms, by the names of their files."""
    return {"report.html": page_html(page).encode(), "report.pdf": page_pdf(page)}


def page_html(page: Page) -> str:
    """The page for the screen."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("reports"),
        autoescape=True,
        trim_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    plots: dict[str, dict[str, Any]] = {}
    first = _with_pictures(page.first, plots) if page.first else None
    parts = [_with_pictures(part, plots) for part in page.parts]
    return environment.get_template("parts.html.j2").render(
        first=first,
        plots=json_in_script(plots) if plots else "",
        plotly=plotly_script() if plots else "",
        js=_template("report.js"),
        kind=page.kind,
        title=page.title,
        headline=page.headline,
        tone=page.tone,
        lead=page.lead,
        notes=page.notes,
        mark=page.mark,
        parts=parts,
        light=style.css_variables("light"),
        dark=style.css_variables("dark"),
        shades_light=style.css_classes("light"),
        shades_dark=style.css_classes("dark"),
        css=_template("report.css"),
    )


def page_pdf(page: Page) -> bytes:
    """The same on paper: PDF/A-2a and PDF/UA-1. Every text reaches Typst as data."""
    import typst

    data: dict[str, Any] = {
        "kind": page.kind,
        "title": page.title,
        "headline": page.headline,
        "tone": page.tone,
        "lead": page.lead,
        "notes": list(page.notes),
        "mark": page.mark,
        "first": page.first and page.first.drawn,
        "parts": [part.drawn for part in page.parts],
        "colors": {name: tone.light for name, tone in style.SURFACE.items()},
    }
    data = _spelled_out(data, _known_characters())
    pdf = typst.compile(  # type: ignore[misc]
        resources.files("reports").joinpath("templates/parts.typ").read_bytes(),
        font_paths=[_font_directory()],
        ignore_system_fonts=True,
        sys_inputs={"report": json.dumps(data, ensure_ascii=False)},
        pdf_standards=["a-2a", "ua-1"],
    )
    return bytes(pdf)


def _template(name: str) -> str:
    return resources.files("reports").joinpath("templates", name).read_text(encoding="utf-8")


def _with_pictures(part: Part, plots: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """What the page shows of a part; its interactive figures go into `plots` by their place on the page."""
    figures = []
    for figure, drawn in zip(part.figures, part.drawn["figures"], strict=True):
        place = f"figure-{len(plots) + 1}"
        if isinstance(figure, Figure):
            plots[place] = plotly_figure(figure)
            figures.append({**drawn, "title": figure.title.as_html(), "plot": place, "uri": ""})
        else:
            uri = "data:image/svg+xml;base64," + base64.b64encode(drawn["svg"].encode()).decode()
            figures.append({**drawn, "title": figure.title.as_html(), "plot": "", "uri": uri})
    return {**part.drawn, "figures": figures}


def _as_data(part: Part) -> dict[str, Any]:
    return {
        "id": part.id,
        "title": part.title,
        "text": part.text,
        "tables": [asdict(t) for t in part.tables],
        "maps": [_map_as_data(m) for m in part.maps],
        "figures": [
            {
                "svg": (svg_figure(f) if isinstance(f, Figure) else f.as_svg()).decode(),
                "title": f.title.plain(),
                "alt": f.alternative_text(),
                "caption": f.caption,
                "wide": f.wide,
            }
            for f in part.figures
        ],
    }


def _map_as_data(m: Map) -> dict[str, Any]:
    rows = [(name, [_cell_as_data(cell) for cell in cells]) for name, cells in m.rows]
    return {"title": m.title, "head": m.head, "rows": rows}


def _cell_as_data(cell: Cell) -> dict[str, Any]:
    background, ink = style.colours(cell.level, "light", negative=cell.negative)
    shade = f"{'below' if cell.negative else 'shade'}-{cell.level}"
    return {"text": cell.text, "shade": shade, "background": background, "ink": ink}
