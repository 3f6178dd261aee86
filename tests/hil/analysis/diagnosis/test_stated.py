"""What a bench file says of its sensors' noise counts."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.diagnosis import diagnose
from hil.analysis.diagnosis.asked import stated_noise
from hil.core.channels import OUTPUTS
from hil.core.recording import read_recording, write_recording
from tests.hil.analysis.diagnosis.one_recording import MODEL, recorded

STATED = b"[noise]\nwheel_speed_rad_s = 0.5\n"


def carrying(bench: bytes):  # type: ignore[no-untyped-def]
    return replace(recorded(), attachments={"bench.toml": bench})


@pytest.mark.parametrize(
    ("bench", "stated"),
    [
        (STATED, {OUTPUTS[1]: 0.5}),
        (b"", {}),
        (b"\xff\xfe", {}),
        (b"noise = 3", {}),
        (b"[noise]\nwheel_speed_rad_s = -1.0\nshaft_torque_nm = nan\nmotor_speed_rad_s = true\noil = 1", {}),
    ],
)
def test_the_bench_file_states_it(bench: bytes, stated: dict[str, float]) -> None:
    assert stated_noise([carrying(bench)]) == stated


def test_the_noisiest_bench_counts() -> None:
    quiet = carrying(STATED.replace(b"0.5", b"0.1"))
    assert stated_noise([quiet, carrying(STATED), recorded()]) == {OUTPUTS[1]: 0.5}


def test_an_export_states_it_too(tmp_path) -> None:  # type: ignore[no-untyped-def]
    write_recording(carrying(STATED), tmp_path / "one.csv")
    assert stated_noise([read_recording(tmp_path / "one.csv")]) == {OUTPUTS[1]: 0.5}


def test_slow_noise_is_borne_where_it_is_stated() -> None:
    """A wheel speed with slow noise: an error that nothing explains, but for what its sensor may do."""
    plain, channel = recorded(seconds=8.0), OUTPUTS[1]
    white = np.random.default_rng(3).normal(0.0, 1.0, len(plain.time_s))
    slow = lfilter([1.0], [1.0, -0.995], white)
    channels = {**plain.channels, channel: plain[channel] + 0.1 * slow / np.std(slow)}
    noisy = replace(plain, channels=channels)
    told = diagnose(MODEL, [replace(noisy, attachments={"bench.toml": STATED})])
    assert told.verdict == "none"
    assert diagnose(MODEL, [noisy], at_most_s=1.0).verdict == "unknown"
