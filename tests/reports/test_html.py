from __future__ import annotations

import json
import re
from pathlib import Path

from lxml import html as lxml_html

from hil.core.recording import Recording
from hil.core.result import RunResult
from reports import write_html
from tests.reports.conftest import HOSTILE


def page(path: Path) -> lxml_html.HtmlElement:
    return lxml_html.fromstring(path.read_bytes().decode())


def words(element: lxml_html.HtmlElement) -> str:
    return " ".join(str(element.text_content()).split())


def test_the_page_says_what_a_signer_asks(acceptance: dict[str, Path], result: RunResult) -> None:
    document = page(acceptance["html"])
    (banner,) = document.xpath("//*[@id='verdict']")
    assert "Passed" in words(banner)
    assert "16 of 16" in words(banner)
    text = words(document.xpath("//main")[0])
    for expected in ("A. Operator", "EA-0042", "deadc42", "3.11.9", "2026-11-30", "Largest value of Ts"):
        assert expected in text
    for criterion in result.criteria:
        (row,) = document.xpath(f"//tr[@id='criterion-{criterion.id}']")
        assert criterion.id in words(row)
        assert criterion.value is not None
        assert f" {criterion.value:.4f}"[:5] in words(row)


def test_the_page_asks_no_network(acceptance: dict[str, Path]) -> None:
    document = page(acceptance["html"])
    assert not document.xpath("//script[@src] | //link | //img[not(starts-with(@src,'data:'))] | //iframe")
    (policy,) = document.xpath("//meta[@http-equiv='Content-Security-Policy']/@content")
    assert policy.startswith("default-src 'none'")
    own = document.xpath("//script")[-1].text
    assert "showSendToCloud: false" in own
    assert "http" not in own


def test_every_figure_has_its_place_data_and_alternative_text(acceptance: dict[str, Path]) -> None:
    document = page(acceptance["html"])
    plots = document.xpath("//*[@class='plot']")
    data = json.loads(document.xpath("//script[@id='figure-data']")[0].text)
    assert [plot.get("id") for plot in plots] == list(data)
    assert len(plots) == 16
    for plot in plots:
        assert plot.get("role") == "group"  # an image could hold no buttons
        assert plot.get("aria-label").startswith("Line chart: ")


def test_no_character_is_in_it_that_html_forbids(acceptance: dict[str, Path]) -> None:
    assert not re.search("[\\x00-\\x08\\x0b\\x0e-\\x1f\\x7f]", acceptance["html"].read_text(encoding="utf-8"))


def test_links_lead_somewhere_and_ids_are_unique(acceptance: dict[str, Path]) -> None:
    document = page(acceptance["html"])
    ids = document.xpath("//@id")
    assert len(set(ids)) == len(ids)
    targets = {link.removeprefix("#") for link in document.xpath("//a/@href")}
    assert targets <= set(ids)
    assert {"criteria", "provenance", "events"} <= targets


def test_tables_have_captions_and_headers(acceptance: dict[str, Path]) -> None:
    for table in page(acceptance["html"]).xpath("//table"):
        assert table.xpath("caption")
        assert table.xpath("thead//th[@scope='col']")


def test_markup_in_a_file_stays_text(hostile: dict[str, Path]) -> None:
    document = page(hostile["html"])
    assert len(document.xpath("//script")) == 3
    assert "<script>alert(1)</script>" in words(document.xpath("//h1")[0])
    source = hostile["html"].read_text()
    assert "<script>alert" not in source
    figures = json.loads(document.xpath("//script[@id='figure-data']")[0].text)
    names = [trace["name"] for figure in figures.values() for trace in figure["data"]]
    assert not any("<script" in name for name in names)


def test_an_unsafe_end_is_shown_loudly(hostile: dict[str, Path]) -> None:
    (alarm,) = page(hostile["html"]).xpath("//*[@id='verdict']//*[@role='alert']")
    assert "Safe state not confirmed" in words(alarm)


def test_unmet_criteria_are_named_in_the_banner(hostile: dict[str, Path]) -> None:
    links = page(hostile["html"]).xpath("//*[@id='verdict']//a/@href")
    assert links == ["#criterion-gain_0kmh.peak_shaft_torque", f"#criterion-{HOSTILE}"]


def test_a_recording_without_figures_needs_no_plotly(tmp_path: Path) -> None:
    write_html(Recording({}, Path("empty.csv")), None, tmp_path / "report.html")
    source = (tmp_path / "report.html").read_text()
    assert len(source) < 50_000
    assert re.search("nothing is judged", source)
