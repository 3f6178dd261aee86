"""`hil evidence verify` and `hil evidence sign` on the folder of a run."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat, PublicFormat

from hil.cli._app import guarded
from hil.core.recording import recover_recording
from reports import claim_of
from tests.hil.cli.test_commands import QUICK, hil

KEY = Ed25519PrivateKey.from_private_bytes(bytes(32))


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    (folder / "quick.yaml").write_text(QUICK.replace("LIMIT", "400"))
    hil("run", folder / "quick.yaml", "--out", folder / "out", "--json")
    return folder / "out"


@pytest.fixture
def run(made: Path, tmp_path: Path) -> Path:
    shutil.copytree(made, tmp_path / "run")
    return tmp_path / "run"


def verified(capsys, *arguments: object) -> dict[str, str]:
    """What does not hold, by file name; the exit code agrees with it."""
    capsys.readouterr()
    code = guarded(["evidence", "verify", *map(str, arguments), "--json"])
    told = json.loads(capsys.readouterr().out)
    wrong = {Path(f["file"]).name: f["text"] for f in told["findings"] if not f["holds"]}
    assert (code, told["verified"]) == ((1, False) if wrong else (0, True))
    return wrong


def test_every_form_of_report_names_the_recording(run: Path) -> None:
    claims = {claim_of(run / name) for name in ("report.html", "report.pdf", "result.json")}
    assert len(claims) == 1
    claim = claims.pop()
    assert claim is not None
    assert claim.recording == "recording.mcap"
    assert len(claim.sha256) == len(claim.samples_sha256) == 64


def test_a_run_is_verified_also_after_its_report_was_made_again(run: Path, capsys) -> None:
    assert verified(capsys, run) == {}
    assert guarded(["report", str(run)]) == 0
    assert verified(capsys, run) == {}
    assert verified(capsys, run / "report.pdf") == {}
    assert verified(capsys, run / "report.html", run / "recording.mcap") == {}


@pytest.mark.parametrize("name", ["recording.mcap", "report.html", "report.pdf", "junit.xml", "result.json"])
def test_a_changed_byte_is_found_and_its_file_named(name: str, run: Path, capsys) -> None:
    content = (run / name).read_bytes()
    for place in (0.02, 0.5, 0.98):
        changed = bytearray(content)
        changed[int(place * len(content))] ^= 1
        (run / name).write_bytes(changed)
        said = verified(capsys, run)
        assert any(name in file or name in text for file, text in said.items()), place
    (run / name).unlink()
    assert name in verified(capsys, run)


def test_figures_that_were_changed_by_hand_are_found(run: Path, capsys) -> None:
    result = json.loads((run / "result.json").read_text())
    result["criteria"][0]["value"] += 1.0
    (run / "result.json").write_text(json.dumps(result, indent=2) + "\n")
    assert "changed" in verified(capsys, run)["result.json"]


def test_a_report_of_another_recording_is_told(run: Path, tmp_path: Path, capsys) -> None:
    hil("export", run / "recording.mcap", "--out", tmp_path / "r.csv")
    assert verified(capsys, run / "report.pdf", tmp_path / "r.csv") == {}  # the same samples
    cut = tmp_path / "recording.mcap"
    content = (run / "recording.mcap").read_bytes()
    cut.write_bytes(content[: len(content) // 2])
    recover_recording(cut, tmp_path / "other.mcap")
    assert (
        "another recording" in verified(capsys, run / "report.html", tmp_path / "other.mcap")["report.html"]
    )
    shutil.copy(run / "report.html", tmp_path)
    assert "another recording" in verified(capsys, tmp_path / "report.html")["report.html"]


def test_a_signed_run_and_what_changes_later(run: Path, tmp_path: Path, capsys) -> None:
    key, public = tmp_path / "key", tmp_path / "key.pub"
    key.write_bytes(KEY.private_bytes(Encoding.PEM, PrivateFormat.OpenSSH, NoEncryption()))
    public.write_bytes(KEY.public_key().public_bytes(Encoding.OpenSSH, PublicFormat.OpenSSH))
    sign = ["evidence", "sign", str(run), "--key", str(key), "--by", "A. Tester"]
    assert "has no valid signature" in verified(capsys, run, "--by", public)["run"]
    assert guarded(sign) == 0
    assert verified(capsys, run, "--by", public) == {}
    (run / "note.txt").write_text("all is well")
    assert set(verified(capsys, run)) == {"note.txt"}
    (run / "note.txt").unlink()
    (run / "report.pdf").write_bytes(b"%PDF forged")
    assert "report.pdf" in verified(capsys, run)
    capsys.readouterr()
    assert guarded([*sign, "--overwrite"]) == 1  # what does not match is not signed
    assert "not signed, because" in capsys.readouterr().err


def test_bad_input_is_one_message(run: Path, tmp_path: Path, capsys) -> None:
    (tmp_path / "key.txt").write_text("no key")
    for arguments, said in (
        (["evidence", "verify", tmp_path / "nothing"], "no such file"),
        (["evidence", "verify", tmp_path / "key.txt"], "is not a folder, and its name ends in none of"),
        (["evidence", "verify", run / "report.pdf", "--by", tmp_path / "key.txt"], "--by goes with a folder"),
        (["evidence", "verify", run, "--by", tmp_path / "key.txt"], "is not a public key"),
        (["evidence", "sign", run, "--key", tmp_path / "key.txt"], "is not a private key"),
        (["evidence", "sign", run / "report.pdf", "--key", tmp_path / "key.txt"], "is not a directory"),
        (["evidence", "sign", run, "--key", run / "key"], "the private key is in the folder"),
    ):
        assert guarded([str(a) for a in arguments]) == 2
        assert said in capsys.readouterr().err
    assert not list(run.glob("signature-*"))
