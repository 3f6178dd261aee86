"""`hil diagnose` on bad and odd input, as a user calls it: one message, exit code 2, nothing written."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hil.analysis.diagnosis import diagnose, examine
from hil.analysis.stretches import unbroken
from hil.cli._app import guarded
from hil.core.errors import BadInputError
from hil.core.model import LOAD_INPUTS, Model, parameter_names, save_model
from hil.core.recording import Recording, read_recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.hidden_cases import EFFECTS, draw
from tests.hil.analysis.diagnosis.reference_plant import BASE, CHANNELS, Truth, recordings

MODEL = Model("three_inertia", dict(BASE))
TORQUE = "motor_torque_ref_nm"
MOTOR, WHEEL, SHAFT = CHANNELS
Change = Callable[[pd.DataFrame], object]


@pytest.fixture(scope="module")
def tables() -> dict[str, pd.DataFrame]:
    """Good recordings by name."""
    return {r.source.stem: pd.DataFrame(r.channels) for r in recordings(Truth(), 6, short=True)}


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Call `hil diagnose` in a directory with model.toml; returns exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)
    save_model(MODEL, tmp_path / "model.toml")

    def call(*arguments: str) -> tuple[int, str, str]:
        code = guarded(["diagnose", "--out", "out", *arguments])
        said = capsys.readouterr()
        return code, said.out, said.err

    return call


def refused(run, *arguments: str) -> str:
    """The message of a call that must be refused."""
    code, out, err = run("--model", "model.toml", *arguments)
    assert (code, out) == (2, ""), err
    assert err.startswith("error: ")
    assert "Traceback" not in err
    assert not Path("out").exists()
    return err


def inverted(name: str) -> Change:
    return lambda t: t.__setitem__(name, -t[name])


def scaled(name: str, factor: float) -> Change:
    return lambda t: t.__setitem__(name, factor * t[name])


def cut(name: str, lower: float, upper: float) -> Change:
    return lambda t: t.__setitem__(name, t[name].clip(lower, upper))


def noise_only(name: str, level: float) -> Change:
    return lambda t: t.__setitem__(name, np.random.default_rng(0).normal(0, level, len(t)))


def frozen(name: str) -> Change:
    return lambda t: t.__setitem__(name, t[name].where(t.index < 3000, t[name][3000]))


def swapped(t: pd.DataFrame) -> None:
    t[MOTOR], t[WHEEL] = t[WHEEL].copy(), t[MOTOR].copy()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (inverted(WHEEL), "wheel_speed_rad_s looks inverted"),
        (inverted(MOTOR), "motor_speed_rad_s looks inverted"),
        (inverted(SHAFT), "shaft_torque_nm looks inverted"),
        (inverted(TORQUE), "motor_torque_ref_nm looks inverted"),
        (swapped, "motor_speed_rad_s and wheel_speed_rad_s look swapped"),
        (scaled(WHEEL, 60 / (2 * np.pi)), "wheel_speed_rad_s looks like rpm"),
        (scaled(MOTOR, 60 / (2 * np.pi)), "motor_speed_rad_s looks like rpm"),
        (scaled(SHAFT, 1e-3), "shaft_torque_nm looks like kN m"),
        (scaled(WHEEL, 0.0), "wheel_speed_rad_s looks dead: it reads 0 throughout"),
        (noise_only(MOTOR, 0.15), "motor_speed_rad_s looks dead: it shows only noise"),
        (noise_only(SHAFT, 1.5), "shaft_torque_nm looks dead: it shows only noise"),
        (scaled(TORQUE, 0.0), "motor_torque_ref_nm looks dead"),
        (frozen(MOTOR), "motor_speed_rad_s looks frozen"),
        (cut(SHAFT, -100.0, 100.0), "shaft_torque_nm looks clipped at 100"),
    ],
)
def test_a_wrong_channel_is_named_with_its_file(change: Change, said: str, tables, run) -> None:
    table = tables["steps"].copy()
    change(table)
    table.to_csv("bad.csv", index=False)
    tables["chirp_low"].to_csv("good.csv", index=False)
    message = refused(run, "good.csv", "bad.csv")
    assert said in message
    assert "bad.csv" in message
    assert "good.csv" not in message
    assert "\n  " in message  # what to do


@pytest.mark.parametrize("others", [(WHEEL, SHAFT), (MOTOR, SHAFT)])
def test_an_inverted_speed_is_seen_by_what_the_torque_does(others: tuple[str, str], tables, run) -> None:
    table = tables["steps"].drop(columns=list(others))
    (speed,) = set(CHANNELS) - set(others)
    table[speed] *= -1.0
    table.to_csv("bad.csv", index=False)
    assert f"{speed} looks inverted: it falls when torque pushes" in refused(run, "bad.csv")


@pytest.mark.parametrize("factor", [0.4, 2.5])
def test_a_wrong_gear_ratio_is_refused(factor: float, tables, run) -> None:
    save_model(MODEL.with_parameters(gear_ratio=factor * BASE["gear_ratio"]), Path("model.toml"))
    tables["chirp_low"].to_csv("r.csv", index=False)
    assert "the gear ratio looks wrong" in refused(run, "r.csv")


def test_a_file_that_is_no_recording_is_refused_with_its_place(tables, run) -> None:
    steps = tables["steps"]
    bad = {
        "head": (steps.iloc[:0], "has 0 samples"),
        "short": (steps.iloc[:150], "150 samples"),
        "slow": (steps.assign(time_s=1000 * steps.time_s), "if it is in milliseconds"),
        "back": (steps.assign(time_s=steps.time_s.where(steps.index != 500, 0.1)), "line 502"),
        "nan": (steps.assign(**{WHEEL: np.nan}), f"100.0% of '{WHEEL}' is NaN"),
        "no_input": (steps.drop(columns=TORQUE), f"no channel '{TORQUE}'"),
        "no_output": (steps[["time_s", TORQUE]], "none of the output channels"),
        "gaps": (steps[(steps.time_s * 10).astype(int) % 2 == 0], "without one between them"),
    }
    for name, (table, said) in bad.items():
        table.to_csv(f"{name}.csv", index=False)
        message = refused(run, f"{name}.csv")
        assert said in message
        assert f"{name}.csv" in message
    Path("empty.csv").write_text("")
    assert "line 1" in refused(run, "empty.csv")
    assert "none.csv" in refused(run, "none.csv")


def test_without_any_motion_there_is_nothing_to_explain(tables, run) -> None:
    rng = np.random.default_rng(0)
    still = {c: rng.normal(0, level, 4000) for c, level in zip(CHANNELS, (0.15, 0.02, 1.5), strict=True)}
    pd.DataFrame({"time_s": np.arange(4000) * 1e-3, TORQUE: 0.0, **still}).to_csv("still.csv", index=False)
    assert "no recording shows motion" in refused(run, "still.csv")


def test_a_file_counts_once(tables, run) -> None:
    tables["steps"].to_csv("r.csv", index=False)
    assert "both as a recording and as --holdout" in refused(run, "r.csv", "--holdout", "./r.csv")
    assert "given twice" in refused(run, "r.csv", "r.csv")


def test_held_out_recordings_are_checked_too(tables, run) -> None:
    tables["chirp_low"].to_csv("r.csv", index=False)
    table = tables["steps"].copy()
    table[WHEEL] *= -1.0
    table.to_csv("held.csv", index=False)
    assert "held.csv: wheel_speed_rad_s looks inverted" in refused(run, "r.csv", "--holdout", "held.csv")


def test_a_place_that_cannot_be_written_is_said_before_the_long_work(tables, run) -> None:
    tables["steps"].to_csv("r.csv", index=False)
    Path("file").write_text("")
    message = refused(run, "r.csv", "--out", "file/out")
    assert "file: is not a directory" in message
    assert "--out" in message


@pytest.mark.slow
def test_odd_recordings_are_handled_and_what_was_done_is_said(tables, run) -> None:
    rng = np.random.default_rng(0)
    low = tables["chirp_low"]
    low = low[(low.time_s < 6) | (low.time_s > 7)]
    low = low[rng.random(len(low)) > 0.01]
    low.assign(time_s=low.time_s + rng.uniform(-2e-4, 2e-4, len(low))).to_csv("uneven.csv", index=False)
    steps = tables["steps"].drop(columns=SHAFT).iloc[::2].copy()
    steps.loc[steps.index[100:110], WHEEL] = np.nan
    steps.to_csv("other_rate.csv", index=False)
    tables["reversals"][["time_s", TORQUE, MOTOR]].to_csv("held.csv", index=False)
    arguments = ["--model", "model.toml", "uneven.csv", "other_rate.csv", "--holdout", "held.csv", "--json"]
    code, out, err = run(*arguments)
    assert code == 0, err
    found = json.loads(out)
    assert found["effects"] == []
    assert set(found["gap"]) == set(CHANNELS)
    assert all(gap["after"] < 1.1 * gap["noise_floor"] for gap in found["gap"].values())
    assert set(found["holdout_gap"]) == {MOTOR}
    notes = " ".join(found["notes"])
    for said in ("cut at gaps: 1", "time stamps jitter", f"10 missing cells of '{WHEEL}'"):
        assert said in notes
    assert json.loads(Path("out/diagnosis.json").read_text()) == found


@pytest.mark.slow
def test_motor_speed_alone_in_one_recording_is_enough(tables, run) -> None:
    tables["steps"][["time_s", TORQUE, MOTOR]].to_csv("r.csv", index=False)
    code, out, err = run("--model", "model.toml", "r.csv")
    assert (code, err) == (0, "")
    assert "verdict: none" in out
    assert "wheel_speed_rad_s" not in out


@pytest.mark.parametrize("effect", EFFECTS)
def test_no_real_effect_is_taken_for_a_wrong_channel(effect: str) -> None:
    truth, _ = draw((effect,), 1.0, 1)
    for recording in recordings(truth, 3, short=True):
        if all(np.all(np.isfinite(recording[c])) for c in CHANNELS):
            assert examine(MODEL, [recording])[1] == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "truth",
    [
        Truth({"gap": 0.05}),
        Truth({"gap": 0.05, "coulomb": 2.0}),
        Truth({"coulomb": 8.0}),
        Truth({"rolling": 60.0, "aero": 0.2}),
        *(Truth(gain={c: g}) for c in CHANNELS for g in (0.8, 1.2)),
        *(Truth({p: BASE[p] * f}) for p in BASE for f in (0.7, 1.3)),
    ],
    ids=lambda t: str({**t.plant, **t.gain}),
)
def test_large_but_real_differences_are_not_refused(truth: Truth) -> None:
    each = recordings(truth, 3, short=True)
    for group in (*([r] for r in each), each):
        assert examine(MODEL, group)[1] == []


def test_a_coast_down_without_any_torque_is_data() -> None:
    (coast,) = recordings(Truth({"rolling": 40.0}), 3, short=True, only=("coast",))
    late = coast.between(1.5, 8.0)
    assert np.ptp(late[TORQUE]) == 0.0
    assert examine(MODEL, [late])[1] == []


def test_a_recording_is_cut_at_its_gaps() -> None:
    time = np.concatenate([np.arange(500), np.arange(800, 900), np.arange(1000, 1500)]) * 1e-3
    whole = Recording({"time_s": time, TORQUE: time, MOTOR: time}, Path("r.csv"))
    pieces = unbroken(whole)
    assert [(p.time_s[0], len(p.time_s)) for p in pieces] == [(0.0, 500), (1.0, 500)]
    assert [str(p.source) for p in pieces] == ["r.csv", "r from 1 s.csv"]
    assert pieces[0].notes == [
        "cut at gaps: 2, the longest of 0.301 s at 0.499 s; short stretches left out: 1"
    ]
    assert unbroken(pieces[1]) == [pieces[1]]


@pytest.mark.parametrize(("empty", "firsts"), [(15, [0.0]), (21, [0.0, 0.521]), (100, [0.0, 0.6])])
def test_a_recording_is_cut_where_a_channel_is_empty(tmp_path: Path, empty: int, firsts: list[float]) -> None:
    """What a straight line over the hole would say is no measurement."""
    time = np.arange(12_000) * 1e-3
    cells = [f"{value:.6f}" for value in np.sin(time)]
    cells[500 : 500 + empty] = [""] * empty
    rows = [f"{t:.3f},{np.cos(t):.6f},{cell}" for t, cell in zip(time, cells, strict=True)]
    (tmp_path / "r.csv").write_text(f"time_s,{TORQUE},{MOTOR}\n" + "\n".join(rows) + "\n")
    pieces = unbroken(read_recording(tmp_path / "r.csv"))
    assert [p.time_s[0] for p in pieces] == firsts
    assert sum(len(p.time_s) for p in pieces) == len(time) - (empty if empty > 20 else 0)
    assert all(len(p.mended[MOTOR]) == (0 if empty > 20 else empty) for p in pieces)


def test_a_hole_in_the_load_cuts_where_the_model_takes_a_load() -> None:
    time, load = np.linspace(0.0, 1.999, 2000), LOAD_INPUTS[0]
    whole = Recording({"time_s": time, TORQUE: time, MOTOR: time, load: time}, Path("r.csv"))
    whole.mended[load] = np.arange(600, 700)
    assert [len(p.time_s) for p in unbroken(whole, load)] == [600, 1300]
    assert unbroken(whole) == [whole]


def test_overlapping_gaps_are_one() -> None:
    time = np.concatenate([np.arange(600), np.arange(700, 2000)]) * 1e-3
    whole = Recording({"time_s": time, TORQUE: time, MOTOR: time}, Path("r.csv"))
    whole.mended[MOTOR] = np.arange(550, 650)  # begins before the pause, ends behind it
    assert [(p.time_s[0], len(p.time_s)) for p in unbroken(whole)] == [(0.0, 550), (0.75, 1250)]


def rounded(recording: Recording, channel: str, step: float) -> Recording:
    channels = dict(recording.channels)
    channels[channel] = np.round(channels[channel] / step) * step
    return dataclasses.replace(recording, channels=channels)


@pytest.mark.slow
@pytest.mark.parametrize("step", [1.0, 3.0, 6.0])
def test_coarse_wheel_speeds_are_data(step: float) -> None:
    each = [rounded(r, WHEEL, step) for r in recordings(Truth(), 3, short=True)]
    traces, _ = examine(MODEL, each)
    held = [r for r in each if np.ptp(r[WHEEL]) == 0.0]
    assert examine(MODEL, held or each, traces)[0]


def test_a_flat_torque_rounded_is_no_clip_and_a_clipped_one_is() -> None:
    time = np.arange(0.0, 8.0, 1e-3)
    torque = 30.0 * np.sign(np.sin(2 * np.pi * 0.5 * time)) + 10.0 * np.sin(2 * np.pi * 0.1 * time)
    rigid = Model("rigid", {k: BASE.get(k, 0.002) for k in parameter_names("rigid")})
    clean = simulate(rigid, torque, 1e-3)
    noise = np.random.default_rng(0).normal(size=(3, len(time))) * np.array([[0.3], [0.03], [0.5]])
    channels = {"time_s": time, TORQUE: torque}
    channels |= {c: clean[c] + n for c, n in zip(CHANNELS, noise, strict=True)}
    good = Recording(channels, Path("steps.csv"))
    assert examine(rigid, [rounded(good, SHAFT, 9.0)])[1] == []
    chirp = 40.0 * np.sin(2 * np.pi * (0.2 * time + 0.1 * time**2))
    channels[TORQUE] = chirp
    seen = simulate(rigid, chirp, 1e-3)
    channels |= {c: seen[c] + n for c, n in zip(CHANNELS, noise, strict=True)}
    top = 0.6 * float(np.max(channels[SHAFT]))
    channels[SHAFT] = np.clip(channels[SHAFT], -top, top)
    with pytest.raises(BadInputError, match="looks clipped"):
        examine(rigid, [rounded(Recording(channels, Path("chirp.csv")), SHAFT, top / 30.0)])


def test_no_recording_is_refused() -> None:
    with pytest.raises(BadInputError, match="no recording"):
        diagnose(MODEL, [])
