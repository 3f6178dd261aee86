"""Recordings given to a service: in pieces, whole or not at all, read apart, studied, removed."""

from __future__ import annotations

import hashlib
import json
import time
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil.api_schemas.recording import RecordingWanted
from hil.api_schemas.study import DiagnosisWanted, IdentificationWanted
from hil.client import Client, RefusedError
from hil.core.errors import BadInputError, BenchError
from tests.hil.service.jobs.test_studies import over
from tests.hil.service.served import RefusedError as Refused
from tests.hil.service.served import Served, served

pytestmark = pytest.mark.slow
_MB = 1_000_000


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("recordings")
    with served(
        folder / "data", "--rate", "1000", "--recordings-gb", "15", state=folder / "state"
    ) as service:
        yield service


def excited_csv(path: Path, names: str = "time_s,motor_torque_ref_nm,motor_speed_rad_s") -> Path:
    """Ten seconds of a chirp from 0.5 to 30 Hz that turns 0.05 kg m² with a first lag of 20 ms."""
    time_s = np.arange(0.0, 10.0, 0.001)
    torque = 20.0 * np.sin(2 * np.pi * (0.5 * time_s + 29.5 / 20.0 * time_s**2))
    speed = np.cumsum(torque) * 0.001 / 0.05
    table = np.column_stack([time_s, torque, speed])
    np.savetxt(path, table, delimiter=",", header=names, comments="", fmt="%.6f")
    return path


def test_a_recording_is_given_identified_and_removed(there: Served, tmp_path: Path) -> None:
    client, shares = Client(there.url), list[float]()
    given = client.give_recording(excited_csv(tmp_path / "drive.csv"), progress=shares.append)
    assert (given.state, given.samples, given.name, given.used) == ("ready", 10_000, "drive.csv", "drive.csv")
    assert given.duration_s == pytest.approx(9.999)
    assert ("motor_speed_rad_s", "rad/s") in [(one.name, one.unit) for one in given.channels]
    assert shares[-1] == 1.0
    assert client.recording(given.id) == given
    listed = client.recordings()[0]
    assert (listed.channel_count, listed.channels) == (3, [])  # a thousand channels of a thousand recordings
    assert listed.model_copy(update={"channels": given.channels, "notes": given.notes}) == given
    client.download_of_recording(given.id, "drive.csv", tmp_path / "back.csv")
    assert (tmp_path / "back.csv").read_bytes() == (tmp_path / "drive.csv").read_bytes()
    asked = client.identify(IdentificationWanted(recordings=[given.id]))
    with pytest.raises(RefusedError, match="is used by the identification"):
        client.remove_recording(given.id)
    study = over(client, asked)
    assert (study.state, study.recordings, study.runs) == ("ended", [given.id], []), study.reason
    client.remove_recording(given.id)
    with pytest.raises(RefusedError, match="there is no recording"):
        client.recording(given.id)
    with pytest.raises(RefusedError, match="there is no recording"):
        client.identify(IdentificationWanted(recordings=[given.id]))
    done = [(one.action, one.target) for one in client.audit()]
    assert ("recording given", f"recording {given.id}") in done
    assert ("recording removed", f"recording {given.id}") in done


def test_a_recording_is_diagnosed_with_one_held_out(there: Served, tmp_path: Path) -> None:
    client = Client(there.url)
    one, other = (client.give_recording(excited_csv(tmp_path / name)) for name in ("a.csv", "b.csv"))
    wanted = DiagnosisWanted(
        model="three_inertia", recordings=[one.id], holdout_recordings=[other.id], at_most_min=0.1
    )
    study = over(client, client.diagnose(wanted))
    assert study.recordings == [one.id, other.id]
    assert study.state in ("ended", "failed")  # the same samples held out are refused in words
    assert study.state == "ended" or "same" in study.reason, study.reason


def test_columns_of_another_tool_are_chosen_after_it_was_refused(there: Served, tmp_path: Path) -> None:
    client = Client(there.url)
    path = excited_csv(tmp_path / "tool.csv", "Zeit,T_req,n_EM")
    with pytest.raises(BadInputError, match="tool.csv: line 1: the header line has no 'time_s'"):
        client.give_recording(path)
    refused = client.recordings()[0]
    assert (refused.state, refused.files) == ("refused", [])
    with pytest.raises(RefusedError, match="is refused"):
        client.identify(IdentificationWanted(recordings=[refused.id]))
    columns = ["time_s=Zeit", "motor_torque_ref_nm=T_req", "motor_speed_rad_s=n_EM, unit=rpm, sign=-1"]
    read = client.read_recording_anew(refused.id, columns)
    assert (read.state, read.used) == ("ready", "tool.channels.parquet")
    assert any("from rpm to rad/s, sign -1" in note for note in read.notes), read.notes
    assert over(client, client.identify(IdentificationWanted(recordings=[read.id]))).state == "ended"


def test_files_of_the_service_are_no_columns(there: Served) -> None:
    for column in ("/etc/passwd.toml", "service.toml", "=x"):
        wanted = {"name": "a.csv", "size": 1, "columns": [column]}
        with pytest.raises(Refused) as refused:
            there.post("/recordings", wanted)
        assert refused.value.status == 422


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("text.mcap", b"nothing of the kind" * 100, "text.mcap"),
        ("cut.mcap", b"\x89MCAP0\r\n" + bytes(300), "cut.mcap"),
        ("zeros.mf4", bytes(4096), "zeros.mf4"),
        ("deep.mat", b"\x89HDF\r\n\x1a\n" + bytes(5000), "deep.mat"),
        ("wide.csv", b",".join(b"c%d" % one for one in range(30_000)) + b"\n", "wide.csv"),
        ("page.parquet", b"PAR1" + b"\xff" * 2000 + b"PAR1", "page.parquet"),
    ],
)
def test_what_is_no_recording_is_refused_in_words(
    there: Served, tmp_path: Path, name: str, content: bytes, why: str
) -> None:
    client = Client(there.url)
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BadInputError, match=why) as refused:
        client.give_recording(tmp_path / name)
    assert "internal error" not in refused.value.what
    assert str(there.data.resolve()) not in refused.value.what
    assert client.health().status == "ok"


def test_a_name_that_the_service_would_not_take_and_an_empty_file(there: Served, tmp_path: Path) -> None:
    client = Client(there.url)
    given = client.give_recording(excited_csv(tmp_path / " Fahrt 3 (kalt).csv"))
    assert given.name == "Fahrt-3-kalt-.csv"
    curves = client.recording_curves(given.id, ["motor_speed_rad_s"], most=100)
    assert [len(one.highest) for one in curves.curves] == [100]
    simulated = client.simulate_recording(given.id, "three_inertia", most=100)
    assert [one.channel for one in simulated.curves] == ["motor_speed_rad_s"]
    with pytest.raises(RefusedError, match="there is no model 'none'"):
        client.simulate_recording(given.id, "none")
    client.remove_recording(given.id)
    (tmp_path / "empty.csv").touch()
    with pytest.raises(BadInputError, match="size"):
        client.give_recording(tmp_path / "empty.csv")
    with pytest.raises(BadInputError, match="columns"):
        client.give_recording(excited_csv(tmp_path / "a.csv"), ["map.toml"])


def test_other_kinds_and_too_much_are_refused_before_a_byte_is_sent(there: Served, tmp_path: Path) -> None:
    client = Client(there.url)
    (tmp_path / "log.blf").write_bytes(b"LOGG")
    with pytest.raises(RefusedError, match="is a log of raw frames"):
        client.give_recording(tmp_path / "log.blf")
    begun = [client._begun(RecordingWanted(name=f"{one}.csv", size=1)) for one in range(4)]
    with pytest.raises(RefusedError, match="4 recordings of local are still arriving"):
        client._begun(RecordingWanted(name="5.csv", size=1))
    client.remove_recording(begun.pop().id)
    with pytest.raises(RefusedError, match=r"are left|the disk has"):
        client._begun(RecordingWanted(name="5.csv", size=16_000_000_000))
    for one in begun:
        client.remove_recording(one.id)


def test_a_gift_goes_on_after_the_service_was_killed_and_appears_whole(tmp_path: Path) -> None:
    path = excited_csv(tmp_path / "drive.csv")
    content = path.read_bytes()
    half = 200_000
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        client = Client(service.url)
        one = client._begun(RecordingWanted(name="drive.csv", size=len(content)))
        client._send_piece(one.id, 0, content[:half])
        with pytest.raises(Refused, match=f"{half} of {len(content)} bytes are here"):
            service.post(f"/recordings/{one.id}/ending", {"sha256": hashlib.sha256(content).hexdigest()})
        service.process.kill()
        service.process.wait()
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        client = Client(service.url)
        found = client.recording(one.id)
        assert (found.state, found.received, found.files) == ("arriving", half, [])
        with pytest.raises(RefusedError, match="is arriving"):
            client.identify(IdentificationWanted(recordings=[one.id]))
        given = client.give_recording(path)
        assert (given.id, given.state) == (one.id, "ready")
        wrong = client._begun(RecordingWanted(name="other.csv", size=3))
        client._send_piece(wrong.id, 0, b"abc")
        service.post(f"/recordings/{wrong.id}/ending", {"sha256": "0" * 64})
        refused = _until(lambda: client.recording(wrong.id), lambda one: one.state == "refused")
        assert "SHA-256 differs" in refused.reason
    left = sorted(path.name for path in (tmp_path / f"data/recordings/{one.id:06d}/results").iterdir())
    assert left == ["drive.csv"]


def test_the_memory_of_the_service_does_not_grow_with_a_file(there: Served, tmp_path: Path) -> None:
    client = Client(there.url)
    path = tmp_path / "large.csv"
    line = b"".join(b"%.3f,%.4f,%.4f\n" % (0.0, 1.0, 2.0) for _ in range(1000))
    with path.open("wb") as file:
        while file.tell() < 300 * _MB:
            file.write(line)
    _peak(there, reset=True)
    before = _peak(there)
    with pytest.raises(BadInputError):  # time stands still, found by the process that reads
        client.give_recording(path)
    grown = _peak(there) - before
    print(f"300 MB given, memory of the service grew by at most {grown / 1e6:.1f} MB")
    assert grown < 30 * _MB
    client.remove_recording(client.recordings()[0].id)


def _peak(service: Served, *, reset: bool = False) -> int:
    """Most memory that the service has taken since it was reset, bytes."""
    place = Path(f"/proc/{service.process.pid}")
    if reset:
        (place / "clear_refs").write_text("5")
    lines = (place / "status").read_text("utf-8").splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM"))


def _until(look: Callable[[], Any], wanted: Callable[[Any], bool], within_s: float = 60.0) -> Any:
    until_s = time.monotonic() + within_s
    while not wanted(found := look()):
        assert time.monotonic() < until_s, found
        time.sleep(0.1)
    return found


def test_a_piece_may_be_longer_than_other_bodies_but_not_than_a_megabyte(there: Served) -> None:
    client = Client(there.url)
    one = client._begun(RecordingWanted(name="long.csv", size=3 * _MB))
    client._send_piece(one.id, 0, bytes(_MB))
    with pytest.raises(BenchError):  # 413, or the connection is closed while it is still sent
        client._send_piece(one.id, _MB, bytes(_MB + 1))
    request = urllib.request.Request(f"{there.url}/api/v1/recordings/{one.id}")
    with urllib.request.urlopen(request) as answer:
        assert json.load(answer)["received"] == _MB
    client.remove_recording(one.id)
