"""What exports keep beside the samples: run, segments, files, events, damage."""

import json

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from asammdf import MDF

from hil.core.recording import Event, Recording, read_recording, run_of, write_recording
from hil.core.result import RunResult, Segment

TIME = np.arange(300) / 1000
RUN = RunResult(
    verdict="pass",
    plan="p",
    bench="sim",
    real_time_factor=1.0,
    bench_time_s=0.3,
    safe_state="confirmed",
    segments=(Segment(id="chirp", start_s=0.05, step_s=0.05, end_s=0.25),),
)


def recording(tmp_path) -> Recording:
    return Recording(
        {"time_s": TIME, "motor_torque_ref_nm": np.sin(TIME), "motor_speed_rad_s": np.cos(TIME)},
        tmp_path / "recording.mcap",
        metadata={"run": {"plan": "p", "started_at": "2026-03-01T08:00:00+01:00"}, "dut": {"serial": "7"}},
        attachments={"run.json": RUN.model_dump_json().encode(), "device.eds": b"\xff\x00 no text"},
        events=[Event(0.05, "segment", "chirp begins")],
        damage=["a block of 1 s is lost at 0.1 s"],
    )


@pytest.fixture(params=["csv", "parquet", "mf4", "mat"])
def exported(request, tmp_path):
    path = tmp_path / f"r.{request.param}"
    write_recording(recording(tmp_path), path)
    return path


def test_an_export_keeps_what_makes_a_recording_evidence(exported, tmp_path):
    again, whole = read_recording(exported), recording(tmp_path)
    assert run_of(again) == RUN
    assert (again.metadata, again.attachments) == (whole.metadata, whole.attachments)
    assert (again.events, again.damage) == (whole.events, whole.damage)


def test_an_export_of_an_export_says_the_same(exported, tmp_path):
    write_recording(read_recording(exported), tmp_path / "twice.csv")
    assert run_of(read_recording(tmp_path / "twice.csv")) == RUN


def test_other_tools_read_the_table_as_before(tmp_path):
    for ending in ("csv", "parquet", "mf4"):
        write_recording(recording(tmp_path), tmp_path / f"r.{ending}")
    assert list(pd.read_csv(tmp_path / "r.csv").columns) == list(recording(tmp_path).channels)
    assert pq.read_table(tmp_path / "r.parquet").to_pandas().shape == (300, 3)
    with MDF(tmp_path / "r.mf4") as mdf:
        np.testing.assert_allclose(mdf.get("motor_speed_rad_s").timestamps, TIME)
        assert mdf.header.start_time.isoformat() == "2026-03-01T08:00:00+01:00"
        assert [(event.name, event.comment) for event in mdf.events] == [("segment", "chirp begins")]
        assert mdf.events[0].value == pytest.approx(0.05)


def test_a_table_without_more_has_no_file_beside_it_and_none_of_an_earlier_one(tmp_path):
    write_recording(recording(tmp_path), tmp_path / "r.csv")
    assert (tmp_path / "r.csv.json").exists()
    plain = Recording(recording(tmp_path).channels, tmp_path / "x.csv")
    write_recording(plain, tmp_path / "r.csv")
    assert not (tmp_path / "r.csv.json").exists()
    assert read_recording(tmp_path / "r.csv").damage == []
    (tmp_path / "r.csv.json").write_text('{"not": "ours"}')
    write_recording(plain, tmp_path / "r.csv")
    assert (tmp_path / "r.csv.json").exists()


def test_a_changed_table_is_said(tmp_path):
    path = tmp_path / "r.csv"
    write_recording(recording(tmp_path), path)
    path.write_text(path.read_text().replace("1.0\n", "2.0\n", 1))
    again = read_recording(path)
    assert run_of(again) == RUN
    assert any("were changed after they had been exported" in one for one in again.damage)


def test_the_text_of_another_table_is_left_out_and_said(tmp_path):
    path = tmp_path / "r.csv"
    write_recording(recording(tmp_path), path)
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:150]))
    again = read_recording(path)
    assert run_of(again) is None
    assert any("written for another table (300 samples" in one for one in again.damage)


@pytest.mark.parametrize("text", ["", "{", "[]", '{"format": "x"}', '{"samples": 1e999}', "\x00"])
def test_a_broken_text_beside_a_table_is_said_and_no_traceback(text, tmp_path):
    path = tmp_path / "r.csv"
    write_recording(recording(tmp_path), path)
    (tmp_path / "r.csv.json").write_text(text)
    assert "r.csv.json is damaged: run and segments are not known" in read_recording(path).damage


def test_an_attachment_that_was_changed_is_not_handed_out(tmp_path):
    path = tmp_path / "r.csv"
    write_recording(recording(tmp_path), path)
    told = json.loads((tmp_path / "r.csv.json").read_text())
    told["attachments"]["run.json"]["text"] += " "
    (tmp_path / "r.csv.json").write_text(json.dumps(told))
    again = read_recording(path)
    assert "run.json" not in again.attachments
    assert any("'run.json' is not as it was written" in one for one in again.damage)
