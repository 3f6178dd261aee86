"""Which recording a report was made from: written into every form of it, and read out again."""

from __future__ import annotations

import html
import json
import logging
import re
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote, unquote

from hil.core.files import read_text, refuse_unless_regular

_HEAD_CHARACTERS = 8192
_NAMES = ("recording", "recording-sha256", "samples-sha256")


@dataclass(frozen=True)
class Claim:
    """The recording that a report says that it was made from: file name, SHA-256 of file and of samples."""

    recording: str
    sha256: str
    samples_sha256: str


def keywords(claim: Claim) -> list[str]:
    """The claim as keywords of a PDF."""
    values = (quote(claim.recording), claim.sha256, claim.samples_sha256)
    return [f"{name}:{value}" for name, value in zip(_NAMES, values, strict=True) if value]


def claim_of(report: Path) -> Claim | None:
    """What a report (.html, .pdf) or result.json says; None if it says nothing, or cannot be read."""
    try:
        refuse_unless_regular(report)
        match report.suffix.lower():
            case ".html":
                found = _of_html(report)
            case ".pdf":
                found = _of_pdf(report)
            case ".json":
                found = _of_result(report)
            case _:
                return None
    except Exception:  # a damaged PDF raises anything
        logging.getLogger(__name__).info("%s cannot be read", report, exc_info=True)
        return None
    if not found.get("recording-sha256"):
        return None
    return Claim(*(found.get(name, "") for name in _NAMES))


def _of_html(report: Path) -> dict[str, str]:
    with report.open(encoding="utf-8", errors="replace") as file:
        head = file.read(_HEAD_CHARACTERS)
    found = re.findall(r'<meta name="([a-z0-9-]+)" content="([^"]*)">', head)
    return {name: html.unescape(value) for name, value in found}


def _of_pdf(report: Path) -> dict[str, str]:
    from pypdf import PdfReader

    stored = getattr(PdfReader(report).metadata, "keywords", None) or ""
    parts = (part.strip().partition(":") for part in str(stored).split(","))
    return {name: unquote(value) for name, _, value in parts}


def _of_result(report: Path) -> dict[str, str]:
    result = json.loads(read_text(report))
    name = str(result["files"]["recording"])
    values = (name, str(result["sha256"][name]), str(result["samples_sha256"]))
    return dict(zip(_NAMES, values, strict=True))
