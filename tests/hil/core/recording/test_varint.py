"""Numbers of variable length, as protobuf writes them."""

from __future__ import annotations

from typing import Any

import pytest
from google.protobuf.internal import decoder, encoder

from hil.core.recording._schema import _read_varint, _varint

ENCODE: Any = encoder._VarintBytes  # type: ignore[attr-defined]
DECODE: Any = decoder._DecodeVarint  # type: ignore[attr-defined]


@pytest.mark.parametrize("value", [0, 1, 126, 127, 128, 129, 16_383, 16_384, 2**32 - 1, 2**63])
def test_numbers_are_protobufs(value: int) -> None:
    assert _varint(value) == ENCODE(value)
    message = b"\x00\x00" + ENCODE(value) + b"\xff"
    assert _read_varint(message, 2) == DECODE(message, 2) == (value, len(message) - 1)


def test_a_number_that_is_cut_off_is_refused() -> None:
    with pytest.raises(ValueError, match="cut off"):
        _read_varint(b"\x80\x80", 0)
