from __future__ import annotations

import re
from pathlib import Path
from typing import Any, cast

from pypdf import PdfReader

from hil.core.recording import Recording
from hil.core.result import RunResult
from reports import write_pdf


def text(path: Path) -> str:
    return "\n".join(page.extract_text() for page in PdfReader(path).pages)


def test_it_is_pdf_a_with_the_fonts_inside(acceptance: dict[str, Path]) -> None:
    reader = PdfReader(acceptance["pdf"])
    metadata = reader.xmp_metadata
    assert metadata is not None
    packet = metadata.stream.get_data().decode()
    assert re.search(r"pdfaid:part>2<", packet)
    assert re.search(r"pdfaid:conformance>A<", packet)
    assert re.search(r"pdfuaid:part>1<", packet)
    assert "/OutputIntents" in reader.root_object
    for page in reader.pages:
        fonts = cast("dict[str, Any]", cast("dict[str, Any]", page["/Resources"])["/Font"])
        for font in fonts.values():
            descendant = font.get_object()["/DescendantFonts"][0].get_object()
            assert {"/FontFile2", "/FontFile3"} & set(descendant["/FontDescriptor"].get_object())


def test_it_has_what_is_signed(acceptance: dict[str, Path], result: RunResult) -> None:
    found = text(acceptance["pdf"])
    for expected in (
        "Passed",
        "Tested by",
        "Approved by",
        "Simulated bench",
        "EA-0042",
        "deadc42",
        "A. Operator",
    ):
        assert expected in found
    for criterion in result.criteria:
        assert criterion.id in found
    assert found.count("PASS") >= len(result.criteria)


def test_every_page_names_the_run_and_its_number(acceptance: dict[str, Path]) -> None:
    pages = PdfReader(acceptance["pdf"]).pages
    for number, page in enumerate(pages, 1):
        found = page.extract_text()
        assert f"Page {number} of {len(pages)}" in found
        assert "2026-03-04T09:15:00+01:00" in found


def test_the_foot_carries_the_recordings_hash(
    recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    recording.source = tmp_path / "recording.mcap"
    recording.source.write_bytes(b"abc")
    recording.channels = {}
    write_pdf(recording, result, tmp_path / "report.pdf")
    assert "SHA-256 ba7816bf8f01" in text(tmp_path / "report.pdf")


def test_made_again_it_is_the_same(
    acceptance: dict[str, Path], recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    again = write_pdf(recording, result, tmp_path / "report.pdf")
    assert again.read_bytes() == acceptance["pdf"].read_bytes()


def test_markup_in_a_file_stays_text(hostile: dict[str, Path]) -> None:
    found = text(hostile["pdf"])
    assert '#panic("x")' in found
    assert "<script>alert(1)</script>" in found
    assert "$x$ *b*" in found
    assert "U+0007" in found
    assert "Safe state not confirmed" in found


def test_many_events_are_cut_and_counted(recording: Recording, tmp_path: Path) -> None:
    recording.channels = {}
    recording.events = recording.events[:1] * 250
    write_pdf(recording, None, tmp_path / "report.pdf")
    assert "50 further events are in the recording" in text(tmp_path / "report.pdf")
