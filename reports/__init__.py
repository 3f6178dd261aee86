"""How results look: HTML, PDF/A and JUnit XML, made from a recording and its result alone."""

from __future__ import annotations

import logging
from pathlib import Path

from hil.core.files import replacing, write_atomically
from hil.core.recording import Recording
from hil.core.result import RunResult
from reports.content import content
from reports.html import html_text, input_texts, recording_named_in, write_html
from reports.junit import junit_text, write_junit
from reports.pdf import pdf_bytes, write_pdf
from reports.report_identity import Claim, claim_of
from reports.sections import sections
from reports.svg_figure import svg_figure

logger = logging.getLogger(__name__)

HTML, PDF, JUNIT = "report.html", "report.pdf", "junit.xml"


def write_reports(recording: Recording, result: RunResult | None, out: Path) -> dict[str, Path]:
    """Write `junit.xml`, `report.html` and `report.pdf` into `out`; nothing is written if one cannot be made.

    Without a result (a recording that another tool made) there is no verdict and no `junit.xml`.

    Returns:
        Paths by 'junit', 'html', 'pdf'.

    Raises:
        BadInputError: `out` cannot be written.
        BenchError: the disk is full.
    """
    verdicts = junit_text(recording, result) if result is not None else None
    written = write_documents(recording, result, out)
    if verdicts is not None:
        write_atomically(out / JUNIT, verdicts)
        written["junit"] = out / JUNIT
    return written


def write_documents(recording: Recording, result: RunResult | None, out: Path) -> dict[str, Path]:
    """Write `report.html` and `report.pdf` into `out`, both or none; paths by 'html', 'pdf'.

    Raises:
        BadInputError: `out` cannot be written.
        BenchError: the disk is full.
    """
    report = content(recording, result)
    page, paper = html_text(report, input_texts(recording)), pdf_bytes(report)
    with replacing(out / HTML) as html, replacing(out / PDF) as pdf:
        html.write_text(page, encoding="utf-8")
        pdf.write_bytes(paper)
    logger.info("wrote %s and %s in %s", HTML, PDF, out)
    return {"html": out / HTML, "pdf": out / PDF}


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


__all__ = [
    "HTML",
    "JUNIT",
    "PDF",
    "Claim",
    "claim_of",
    "recording_named_in",
    "write_documents",
    "write_figures",
    "write_html",
    "write_junit",
    "write_pdf",
    "write_reports",
]
