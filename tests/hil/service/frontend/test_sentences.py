"""What the engine says of a run is in the reader's language: its sentences have words on the page.

Sentences are read from the source, so that a new one is found without a fault that makes it be said. Its
limits: a text that is put together over several functions is read in its parts, with the values given here;
what libraries and drivers of others say stays as they say it; mistakes of files (bench files, plans) and
notes of a computation are English in any language (docs/how-to/translate.md) and are not looked for; one word
alone is no sentence.
"""

from __future__ import annotations

import functools

import pytest

from tests.hil.service.frontend.sentences import NODE, ROOT, sentences, unknown

#: Packages and modules that say what becomes of a run.
_SAID_BY = (
    "drivers",
    "hil/app/run.py",
    "hil/app/worker",
    "hil/core/can/xcp.py",
    "hil/engine/bench/bench.py",
    "hil/engine/bench/bench_channels.py",
    "hil/engine/bench/bench_lock.py",
    "hil/engine/ipc",
    "hil/engine/process",
    "hil/engine/run",
    "hil/engine/stop",
    "hil/execution",
    "sim_backend/udp_interface.py",
    "test_plans/evidence",
    "test_plans/judging.py",
    "test_plans/metrics",
)
#: Tables of bench files, and what only `hil bench check` reports.
_ELSEWHERE = ("_table.py", "table.py", "_examination.py")
_IN_FORMS_AND_REPORTS = (
    *("definition", "window", "transient_in_words", "_at", "_firmly", "_origin", "_reference_in_words"),
    *("objection", "objection_to_limits", "no_step", "not_comparable", "not_checked"),
    *("examine", "_proofs"),
)
#: What stands in a sentence that is put together elsewhere.
_VALUES = {
    "_advice": "lower the plan's torque or speed",
    "_how_to_reset": "hil bench reset sim --by NAME",
    "shown": "though it had noise before",
    "stabilization": "gain",
    "turns": "the axle turns: motor_speed_rad_s reads 7 rad/s",
}
#: Parts of sentences that have words as a whole, and what never reaches the page.
_PARTS = {
    # of sentences with words
    "7 is in '7'",
    "sending failed",
    "receiving failed",
    "reading its state",
    "not recorded any longer; the axle turns: motor_speed_rad_s reads 7 rad/s",
    "stopped once more; the axle turns: motor_speed_rad_s reads 7 rad/s",
    "the axle stands",
    "the speed is no longer measured",
    "though it had noise before",
    "check the file; then: {reset}",
    "hil bench reset 7 --by NAME",
    "reset it at its service, or: hil bench reset 7 --by NAME --data 7",
    "start again: the bench is simulated in this process, and its stop ends with the process",
    "requested by 7 at the bench service",
    "requested by 7 from 77",
    "requested by 77",
    "over the service's API",
    "on the service's page",
    "emergency stop since 7, by 7: 7",
    "the {who} ended before the recording started; the run can be queued again",
    "the {who} ended during the run; data measured before that is kept",
    "7, approved by 7",
    "segment '7' was stopped after 7 s; : the control loop is not stable",  # never without a reason
    # what others say, and what is looked for in it
    "Failed to receive: 7",
    "Failed to transmit: 7",
    "a frame has at most 7 bytes here, not 7",
    "simulated bench at 7",
    "Could not read from serial device: 7",
    "Could not write to serial device: 7",
    "Transmit buffer full",
    "buffer full",
    "buffer overflow",
    "library not found",
    "queue full",
    "queue is full",
    "not confirmed",
    "the bench loop was delayed",
    # names in files and states of CiA 402
    "SDO request",
    "Shaft torque",
    "Target velocity",
    "Torque actual value",
    "Vehicle speed",
    "Wheel speed",
    "operation enabled",
    "quick stop active",
    "ready to switch on",
    "switch on disabled",
    "switched on",
    "torque request",
    # at the terminal, in the report, between processes, as a service starts
    "r and Enter: resume; q and Enter: end the run",
    "Press Enter to continue, q and Enter to end the run. Other text is a remark: the run goes on.",
    "the operator",
    "its own frames",
    "counts the samples of the time base",
    "stamps of the adapter on the bench clock",
    "time stamps of its DAQ list",
    "the run is still active",
    "there was no run",
    "safe state 7",
    "7 does not pass",
    "error: the command has ended before its run",
    "--model goes with a simulated bench only",
    "leave --model out",
    "the name '7' is used by two benches",
    "rename one of them in its file",
    "another 7 keeps its data here: 7",
    "cannot be made its owner's alone: 7",
    "give a folder of your own with --data",
    # of mistakes in files and of the definitions of metrics
    "it is computed with [limits.twist]",
    "there are: 7",
    "the time base",
    "in steps, T_s comes within 7 ms of N T_m",
    "in steps under a vehicle, T_s over the acceleration is 7 to 7 kg m²",
}


@functools.cache
def _every_sentence() -> dict[str, str]:
    found: dict[str, str] = {}
    for name in _SAID_BY:
        for path in [ROOT / name] if name.endswith(".py") else sorted((ROOT / name).rglob("*.py")):
            if path.name not in _ELSEWHERE:
                said = sentences(path.read_text("utf-8"), _IN_FORMS_AND_REPORTS, _VALUES)
                found |= dict.fromkeys(said, path.relative_to(ROOT).as_posix())
    return found


@pytest.mark.skipif(not NODE.is_file(), reason="there is no node: make page")
def test_every_sentence_of_a_run_has_words() -> None:
    found = _every_sentence()
    assert len(found) > 400
    asked = [text for text in found if text not in _PARTS]
    assert {text: found[text] for text in unknown(asked)} == {}


def test_every_part_is_still_said() -> None:
    assert sorted(_PARTS - set(_every_sentence())) == []


_NEW = """
def refuse(name):
    'A docstring that is no sentence for people.'
    why = "of the wind" if name else "of the rain"
    logger.info("the moon is up")
    raise BenchError(f"the moon is dark because {why}", fix="wait for a night")
"""


@pytest.mark.skipif(not NODE.is_file(), reason="there is no node: make page")
def test_a_new_sentence_is_found() -> None:
    said = sentences(_NEW)
    assert unknown([*said, "the RMCU sends no status"]) == [
        "the moon is dark because of the wind",
        "the moon is dark because of the rain",
        "wait for a night",
    ]
