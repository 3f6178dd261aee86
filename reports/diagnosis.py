"""The report of a diagnosis: the gap before and after, what was named and why.

Both forms are made from one list of sections (`reports.diagnosis_content`).
"""

from __future__ import annotations

from typing import Literal

from hil.analysis.diagnosis import Diagnosis
from reports.diagnosis_content import first, headline, lead, parts
from reports.labels import as_sentence, with_titles
from reports.origin import Origin
from reports.parts import Page, documents, page_html, page_pdf

_Tone = Literal["pass", "error"]


def diagnosis_documents(found: Diagnosis, title: str, origin: Origin | None = None) -> dict[str, bytes]:
    """Both forms, by the names of their files."""
    return documents(_page(found, title, origin))


def diagnosis_html(found: Diagnosis, title: str, origin: Origin | None = None) -> str:
    """The page: one file with interactive figures."""
    return page_html(_page(found, title, origin))


def diagnosis_pdf(found: Diagnosis, title: str, origin: Origin | None = None) -> bytes:
    """The same on paper: PDF/A-2a and PDF/UA-1. Every text reaches Typst as data."""
    return page_pdf(_page(found, title, origin))


def _page(found: Diagnosis, title: str, origin: Origin | None) -> Page:
    return Page(
        kind="Diagnosis of a model against recordings",
        title=title,
        headline=headline(found),
        tone=_tone(found),
        lead=lead(found),
        notes=tuple(map(_sentence, found.notes)),
        parts=(*parts(found), *((origin.part,) if origin else ())),
        mark=origin.mark if origin else "",
        first=first(found),
    )


def _sentence(note: str) -> str:
    """A note as it stands in a text; a recording's name, which comes before a colon, stays as it is."""
    text = as_sentence(with_titles(note))
    return note[:1] + text[1:] if note.partition(" ")[0].endswith(":") else text


def _tone(found: Diagnosis) -> _Tone:
    """A name that leaves much, or makes something worse, is no good news."""
    doubts = (*found.open_channels, *found.held_out_open, *found.worse)
    return "pass" if found.verdict != "unknown" and not doubts else "error"
