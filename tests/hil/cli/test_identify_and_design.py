"""`hil identify` and `hil design` as a user calls them, one after the other."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest
from pypdf import PdfReader
from typer.testing import CliRunner

from hil.cli._app import app_of
from hil.core.controller import load_controller
from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.core.recording import write_recording
from tests.hil.analysis import paper_plant

pytestmark = pytest.mark.slow

_FIGURES = {f"{n}.{kind}" for n in ("nyquist", "sensitivity", "trade_off") for kind in ("png", "svg")}


def invoke(*arguments: object) -> str:
    result = CliRunner().invoke(
        app_of("identify", "design"), [str(a) for a in arguments], catch_exceptions=False
    )
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "chirp.parquet"
    write_recording(paper_plant.recording(paper_plant.chirp(120.0)), path)
    return path


@pytest.fixture(scope="module")
def identified(recording: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    out = tmp_path_factory.mktemp("identified") / "new" / "directory"
    return out, invoke("identify", recording, "--out", out, "--json")


def test_identify_writes_what_it_promises(identified: tuple[Path, str], recording: Path) -> None:
    out, printed = identified
    summary = json.loads(printed)
    assert json.loads((out / "identification.json").read_text()) == summary
    assert summary["dead_time_s"]["value"] == pytest.approx(0.008, abs=1e-4)
    assert summary["chain"] == "three_inertia"
    assert {p.name for p in out.iterdir()} == {*summary["files"], "identification.json"}
    page = (out / "report.html").read_text()
    assert hashlib.sha256(recording.read_bytes()).hexdigest() in page
    assert "pdfuaid" in str(PdfReader(out / "report.pdf").xmp_metadata.stream.get_data())
    assert load_model(out / "model.toml").kind == "transfer_function"
    assert load_model(out / "physical.toml").kind == "three_inertia"


def test_design_takes_either_model(identified: tuple[Path, str], tmp_path: Path) -> None:
    out, _ = identified
    for name in ("model.toml", "physical.toml"):
        where = tmp_path / name
        summary = json.loads(invoke("design", "--model", out / name, "--out", where, "--json"))
        assert {p.name for p in where.iterdir()} == {
            "controller.toml", "design.json", "report.html", "report.pdf", *_FIGURES
        }  # fmt: skip
        assert load_controller(where / "controller.toml").stabilization == "phase"
        assert summary["loops"]["phase"]["sampled"]["stable"] is True


def test_text_names_the_evidence(recording: Path, tmp_path: Path) -> None:
    text = invoke("identify", recording, "--out", tmp_path, "--order", "5", "--gear-ratio", "8.148")
    assert "dead time 8.0" in text
    assert "three_inertia  " in text
    assert "<- chosen" in text


def test_notch_on_the_command_line(identified: tuple[Path, str], tmp_path: Path) -> None:
    model = identified[0] / "model.toml"
    text = invoke("design", "--model", model, "--out", tmp_path, "--notch-hz", "10.6", "--pole", "0.25")
    assert "p 0.25 rad/s" in text
    assert load_controller(tmp_path / "controller.toml").stabilization == "gain"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--segment", "x"], "no segment 'x'"),
        (["--input", "nothing"], "no channel 'nothing'"),
        (["--method", "magic"], "--method is 'magic'"),
        (["--from-hz", "0.001"], "too short"),
        (["--from-hz", "30", "--to-hz", "1"], "--from-hz 30 is not below --to-hz 1"),
    ],
)
def test_bad_input_writes_nothing(
    recording: Path, tmp_path: Path, arguments: list[str], message: str
) -> None:
    out = tmp_path / "out"
    with pytest.raises(BadInputError, match=message):
        invoke("identify", recording, "--out", out, *arguments)
    assert not out.exists()


def test_bad_choice_of_design(identified: tuple[Path, str], tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="--normalisation is 'x'"):
        invoke(
            "design", "--model", identified[0] / "model.toml", "--out", tmp_path / "o", "--normalisation", "x"
        )
    assert not (tmp_path / "o").exists()
