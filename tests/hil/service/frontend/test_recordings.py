"""Recordings given on the page: in pieces, refused in words, read with other columns, studied, removed."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from hil.api_schemas.recording import RecordingWanted
from hil.client import Client
from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, choice, expect, heading, region, to
from tests.hil.service.looks import expect_drawn, refuse_hard_to_use
from tests.hil.service.recordings.test_given_recordings import excited_csv
from tests.hil.service.served import Served, served

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("page-recordings")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        yield service


def test_a_recording_is_given_identified_from_and_removed(
    page: playwright.Page, there: Served, tmp_path: Path
) -> None:
    to(page, there, "recordings")
    expect(page.get_by_text("None yet: give one above")).to_be_visible()
    page.get_by_label("File of a recording").set_input_files(excited_csv(tmp_path / "drive (1).csv"))
    page.get_by_role("button", name="Give the recording").click()
    expect(heading(page, re.compile("drive-1-.csv ready"))).to_be_visible()
    expect(page.locator(".facts")).to_contain_text("samples10,000")
    expect(region(page, "Channels").locator("table")).to_contain_text("motor_speed_rad_srad/s")
    curves = region(page, "Curves")
    expect_drawn(curves.locator("figure.plot", has_text="motor speed"), "gain")
    page.set_viewport_size({"width": 1280, "height": 900})
    choice(page, "Model driven by its torque").select_option("three_inertia")
    expect(curves).to_contain_text(re.compile("gap to the model [0-9]"), timeout=120_000)
    refuse_hard_to_use(page)
    page.get_by_role("link", name="Identify a model").click()
    expect(page.get_by_label("recording 1: drive-1-.csv")).to_be_checked()
    page.get_by_role("button", name="Identify", exact=True).click()
    expect(heading(page, re.compile("Identification 1 ended"))).to_be_visible(timeout=240_000)
    page.get_by_role("link", name="recording 1").click()
    page.get_by_role("button", name="Remove the recording").click()
    answer(page, "Remove")
    expect(page.get_by_text("None yet: give one above")).to_be_visible()


def test_a_file_of_another_tool_is_refused_in_words_and_read_with_its_columns(
    page: playwright.Page, there: Served, tmp_path: Path
) -> None:
    to(page, there, "recordings")
    path = excited_csv(tmp_path / "tool.csv", "Zeit,T_req,n_EM")
    page.get_by_label("File of a recording").set_input_files(path)
    page.get_by_role("button", name="Give the recording").click()
    expect(heading(page, re.compile("tool.csv refused"))).to_be_visible()
    expect(page.locator("main").get_by_role("alert")).to_contain_text("the header line has no 'time_s'")
    refuse_hard_to_use(page)
    columns = "time_s=Zeit\nmotor_torque_ref_nm=T_req\nmotor_speed_rad_s=n_EM, unit=rpm"
    page.get_by_label("Columns of another tool's file").fill(columns)
    page.get_by_role("button", name="Read it anew").click()
    expect(heading(page, re.compile("tool.csv ready"))).to_be_visible()
    expect(region(page, "What reading it assumed")).to_contain_text("converted from rpm to rad/s")
    to(page, there, "diagnoses")
    expect(page.get_by_label(re.compile("recording .: tool.csv")).first).to_be_visible()
    refuse_hard_to_use(page)


def test_a_gift_goes_on_where_it_ended(page: playwright.Page, there: Served, tmp_path: Path) -> None:
    path = excited_csv(tmp_path / "again.csv")
    content, client = path.read_bytes(), Client(there.url)
    one = client._begun(RecordingWanted(name="again.csv", size=len(content)))
    client._send_piece(one.id, 0, content[:100_000])
    to(page, there, f"recordings/{one.id}")
    expect(heading(page, re.compile("again.csv arriving"))).to_be_visible()
    to(page, there, "recordings")
    expect(page.get_by_role("row", name=re.compile("again.csv"))).to_contain_text("34% is here")
    refuse_hard_to_use(page)
    sent: list[str] = []
    page.on("request", lambda request: sent.append(request.url) if "/content?" in request.url else None)
    page.get_by_label("File of a recording").set_input_files(path)
    page.get_by_role("button", name="Give the recording").click()
    expect(heading(page, re.compile("again.csv ready"))).to_be_visible()
    assert page.url.endswith(f"/recordings/{one.id}")
    assert sum("at=100000&" in url for url in sent) == 1
