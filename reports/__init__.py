"""How results look: HTML, PDF/A and JUnit XML, made from a recording and its result alone."""

from __future__ import annotations

from pathlib import Path

from hil.core.files import write_atomically
from hil.core.recording import Recording
from hil.core.result import RunResult
from reports.content import content
from reports.html import html_text, input_texts, write_html
from reports.junit import junit_text, write_junit
from reports.pdf import pdf_bytes, write_pdf
from reports.sections import sections
from reports.svg_figure import svg_figure

HTML, PDF, JUNIT = "report.html", "report.pdf", "junit.xml"


def write_reports(recording: Recording, result: RunResult | None, out: Path) -> dict[str, Path]:
    """Write `report.html`, `report.pdf` and `junit.xml` into `out`; nothing is written if one cannot be made.

    Without a result (a recording that another tool made) there is no verdict and no `junit.xml`.

    Returns:
        Paths by 'html', 'pdf', 'junit'.

    Raises:
        BadInputError: `out` cannot be written.
    """
    report = content(recording, result)
    contents: dict[str, tuple[Path, str | bytes]] = {
        "html": (out / HTML, html_text(report, input_texts(recording))),
        "pdf": (out / PDF, pdf_bytes(report)),
    }
    if result is not None:
        contents["junit"] = (out / JUNIT, junit_text(recording, result))
    for path, made in contents.values():
        write_atomically(path, made)
    return {name: path for name, (path, _) in contents.items()}


def write_figures(recording: Recording, result: RunResult | None, out: Path) -> dict[str, Path]:
    """Write every figure of the report as an SVG for paper into `out`; paths by the figures' ids.

    Raises:
        BadInputError: `out` cannot be written.
    """
    paths = {}
    for section in sections(recording, result):
        for figure in section.figures:
            paths[figure.id] = out / f"{figure.id}.svg"
            write_atomically(paths[figure.id], svg_figure(figure))
    return paths


__all__ = ["write_figures", "write_html", "write_junit", "write_pdf", "write_reports"]
