"""Sound recordings are never refused: no check takes what a plant of the set does for a broken channel."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.analysis.diagnosis import examine
from hil.core.model import load_model
from hil.core.recording import read_recording
from tests.blind.casefiles import write_case
from tests.blind.draws import draw
from tests.blind.specs import Spec, full_set

_SEED, _EVERY = 7, 36
#: Rounded so coarsely that a channel may show a single value in most recordings: that is refused as dead.
_ALL_BUT_DEAD = ("sensor_quantization", "large")
_SPECS = [spec for spec in full_set() if (spec.subject, spec.size) != _ALL_BUT_DEAD]


@pytest.mark.slow
@pytest.mark.parametrize("spec", _SPECS[::_EVERY], ids=lambda spec: spec.key)
def test_no_case_is_refused(spec: Spec, tmp_path: Path) -> None:
    files, _ = write_case(draw(_SEED, spec, 1.0), tmp_path)
    model = load_model(files.model)
    traces, _ = examine(model, [read_recording(path) for path in files.recordings])
    assert traces
    assert examine(model, [read_recording(path) for path in files.holdout], traces)[0]
