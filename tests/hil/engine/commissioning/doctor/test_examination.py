"""What an examination comes to."""

from drivers import Finding
from hil.engine.commissioning.doctor.examination import DeviceFacts, Examination


def verdict(rmcu, dyno, *severities):
    devices = {"rmcu": DeviceFacts("rmcu-can", rmcu), "dyno": DeviceFacts("rcs-canopen", dyno)}
    findings = [Finding(severity, "odd", "there") for severity in severities]
    return Examination("test", True, 1.0, devices=devices, findings=findings).verdict


def test_hints_change_no_verdict():
    assert verdict(True, True) == "fine"
    assert verdict(True, True, "hint") == "fine"
    assert verdict(True, True, "hint", "fault") == "faults"


def test_a_bench_is_there_while_one_of_its_devices_answers():
    assert verdict(True, False, "fault") == "faults"
    assert verdict(False, False, "fault") == "not_there"
    assert verdict(None, None) == "not_there"
