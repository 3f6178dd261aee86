"""What no physics can explain is refused by name; noise is read once and handed on."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.data._noise import noise_levels
from hil.analysis.diagnosis.data._sanity import examine, examined
from hil.core.errors import BadInputError
from tests.hil.analysis.diagnosis.one_recording import MODEL, recorded


def test_good_recordings_come_with_their_noise() -> None:
    found = examined(MODEL, [recorded()])
    assert np.array_equal(found.noise, noise_levels(found.traces))
    assert found.notes == examine(MODEL, [recorded()])[1] == []


def test_nothing_is_examined_where_nothing_is_given() -> None:
    assert examined(MODEL, []).traces == []


def test_an_inverted_channel_is_named() -> None:
    one = recorded(seconds=8.0)
    turned = dataclasses.replace(one, channels={**one.channels, "shaft_torque_nm": -one["shaft_torque_nm"]})
    with pytest.raises(BadInputError, match="shaft_torque_nm looks inverted"):
        examined(MODEL, [turned])
