"""Exchanges with a panel, byte by byte."""

from __future__ import annotations

import contextlib

import pytest

from drivers import Panel
from hil.core.errors import BenchError
from hil.core.vehicle import VehicleAndRoad
from tests.drivers.panel.scripted import ScriptedLine, as_line, loop

REMOTE = (b"\x02 SREM K0\x03", b"\x02 SREM 0\x03")
STATE = (b"\x02 ASTZ K0\x03", b"\x02 ASTZ 0 SREM\x03")
NO_ALARM = (b"\x02 ASTF K0\x03", b"\x02 ASTF 0 0\x03")
MASS = (b"\x02 EMAS K0 1500\x03", b"\x02 EMAS 0\x03")
MASS_READ = (b"\x02 AMAS K0\x03", b"\x02 AMAS 0 1500\x03")
HEAVY = VehicleAndRoad(mass_kg=1500)


def panel(*exchanges) -> tuple[Panel, ScriptedLine]:
    line = ScriptedLine(*exchanges)
    return Panel("panel", as_line(line), loop()), line


def test_it_comes_up_remote_and_without_alarm() -> None:
    device, line = panel(REMOTE, STATE, NO_ALARM)
    device.come_up()
    assert (device.state, device.alarms, device.troubles()) == ("SREM", (), [])
    line.close()


def test_alarms_are_reset_once() -> None:
    alarm = (b"\x02 ASTF K0\x03", b"\x02 ASTF 0 17\x03")
    reset = (b"\x02 SRES K0\x03", b"\x02 SRES 0\x03")
    device, line = panel(REMOTE, STATE, alarm, reset, STATE, NO_ALARM)
    device.come_up()
    line.close()
    device, line = panel(REMOTE, STATE, alarm, reset, STATE, alarm)
    with pytest.raises(BenchError, match="has alarms: 17"):
        device.come_up()
    assert device.troubles() == ["alarm 17"]
    line.close()


def test_what_was_written_is_what_reads_back() -> None:
    device, line = panel(
        MASS,
        MASS_READ,
        (b"\x02 EFW0 K0 120\x03", b"\x02 EFW0 0\x03"),
        (b"\x02 AFW0 K0\x03", b"\x02 AFW0 0 120.0\x03"),
        (b"\x02 EFW1 K0 1.5\x03", b"\x02 EFW1 0\x03"),
        (b"\x02 AFW1 K0\x03", b"\x02 AFW1 0 1.5\x03"),
        (b"\x02 EFW2 K0 0.4\x03", b"\x02 EFW2 0\x03"),
        (b"\x02 AFW2 K0\x03", b"\x02 AFW2 0 0.4\x03"),
        (b"\x02 ESLP K0 2.5\x03", b"\x02 ESLP 0\x03"),
        (b"\x02 ASLP K0\x03", b"\x02 ASLP 0 2.5\x03"),
    )
    told = device.set_vehicle(VehicleAndRoad(mass_kg=1500, f0_n=120, f1_ns_m=1.5, f2_ns2_m2=0.4, slip=0.025))
    assert told == {
        "vehicle mass": "1500 kg",
        "road load f0": "120 N",
        "road load f1": "1.5 N s/m",
        "road load f2": "0.4 N s²/m²",
        "slip": "2.5 %",
    }
    line.close()


def test_friction_has_no_unit() -> None:
    device, line = panel(
        (b"\x02 EMUL K0 0.05\x03", b"\x02 EMUL 0\x03"),
        (b"\x02 AMUL K0\x03", b"\x02 AMUL 0 0.05\x03"),
        (b"\x02 EMUR K0 1\x03", b"\x02 EMUR 0\x03"),
        (b"\x02 AMUR K0\x03", b"\x02 AMUR 0 1\x03"),
    )
    told = device.set_vehicle(VehicleAndRoad(friction_left=0.05, friction_right=1.0))
    assert told == {"friction left": "0.05", "friction right": "1"}
    line.close()


def test_another_value_is_no_confirmation() -> None:
    device, line = panel(MASS, (b"\x02 AMAS K0\x03", b"\x02 AMAS 0 1400\x03"))
    with pytest.raises(BenchError, match="vehicle mass reads back as 1400 kg, 1500 was written"):
        device.set_vehicle(HEAVY)
    line.close()


@pytest.mark.parametrize(("stands", "fits"), [("1500.1", True), ("1499.9", True), ("1500.2", False)])
def test_what_reads_back_may_be_rounded(stands: str, fits: bool) -> None:
    device, line = panel(MASS, (b"\x02 AMAS K0\x03", f"\x02 AMAS 0 {stands}\x03".encode()))
    with contextlib.nullcontext() if fits else pytest.raises(BenchError, match="reads back as"):
        device.set_vehicle(HEAVY)
    line.close()


@pytest.mark.parametrize(
    "answers",
    [
        pytest.param((b"\x02 EM", b"AS 0", b"\x03"), id="in pieces"),
        pytest.param((b"\xff\x00garbage\x03", b"\x02 EMAS 0\x03"), id="after garbage"),
        pytest.param((b"\x02 EMAS K0 1500\x03", b"\x02 EMAS 0\x03"), id="after its echo"),
        pytest.param((b"\x02 AST\x02 EMAS 0\x03",), id="after half a telegram"),
        pytest.param((b"\x02 ASTZ 0 SREM\x03\x02 EMAS 0\x03",), id="behind an answer to something else"),
    ],
)
def test_an_answer_is_found_among_what_else_comes(answers: tuple[bytes, ...]) -> None:
    device, line = panel((MASS[0], *answers), MASS_READ)
    assert device.set_vehicle(HEAVY) == {"vehicle mass": "1500 kg"}
    line.close()


def test_a_panel_that_does_not_answer_is_asked_three_times() -> None:
    device, line = panel((MASS[0],), (MASS[0], b"\x02 EMAS"), MASS, MASS_READ)
    assert device.set_vehicle(HEAVY) == {"vehicle mass": "1500 kg"}
    line.close()
    device, line = panel((MASS[0],), (MASS[0],), (MASS[0],))
    with pytest.raises(BenchError, match=r"no answer to EMAS in 3 attempts of 0.3 s"):
        device.set_vehicle(HEAVY)
    line.close()


def test_a_busy_panel_is_asked_again_for_a_while() -> None:
    busy = (MASS[0], b"\x02 EMAS 1 BS\x03")
    device, line = panel(busy, busy, busy, MASS, MASS_READ)
    assert device.set_vehicle(HEAVY) == {"vehicle mass": "1500 kg"}
    line.close()
    device, line = panel(*[busy] * 100)
    with pytest.raises(BenchError, match="is busy for more than 3 s"):
        device.set_vehicle(HEAVY)
    assert 60 < len(line.left) < 80  # 20 to 40 were sent


@pytest.mark.parametrize(
    ("answer", "what"),
    [
        (b"\x02 EMAS 1 OF\x03", "is not in remote mode"),
        (b"\x02 EMAS 1 DF\x03", "refuses the value"),
        (b"\x02 EMAS 1 XX\x03", "says XX"),
        (b"\x02 ???? 1 SE\x03", "does not know it"),
    ],
)
def test_a_refusal_is_told_in_words_and_not_repeated(answer: bytes, what: str) -> None:
    device, line = panel((MASS[0], answer))
    with pytest.raises(BenchError, match=what):
        device.set_vehicle(HEAVY)
    line.close()


def test_beats_ask_and_silence_local_and_alarms_are_troubles() -> None:
    device, line = panel(
        (STATE[0],),
        (NO_ALARM[0],),
        (STATE[0], b"\x02 ASTZ 0 SMAN\x03"),
        (NO_ALARM[0], b"\x02 ASTF 0 3 4\x03"),
    )
    device.beat()
    device._loop.run_for(3.5)
    assert device.troubles() == ["the panel has sent nothing for 3.5 s"]
    device.beat()
    device._loop.run_for(0.1)
    assert device.troubles() == ["alarm 3", "alarm 4", "the panel was switched to local"]
    line.close()


def test_it_is_examined_by_asking_alone() -> None:
    device, line = panel(STATE, (b"\x02 ASTF K0\x03", b"\x02 ASTF 0 17\x03"))
    assert [f.severity for f in device.examine(ask=False).findings] == ["hint"]
    found = device.examine(ask=True)
    assert found.answers
    assert found.facts == {"state": "remote"}
    assert [f.what for f in found.findings] == ["alarm 17"]
    line.close()
