"""Bytes that were whole once: changed, left out, doubled, with what parsers trip over put in."""

from __future__ import annotations

import random

_NASTY = (
    b"\x00", b"\xff\xff\xff\xff", b"\x7f", b"\n", b"nan", b"inf", b"-1", b"1e999", b"{", b"[", b"]", b'"',
    b"'", b"&a *a", b"!!python/object:os.system", b"<<:", b"\xc3\x28", b"\xef\xbb\xbf", b"0" * 400, b"9" * 40,
    b"[" * 300, b"- " * 300, b"=", b".", b"..", b"/", b"\xf0\x9f\x98\x80", b"true", b"null", b",", b";",
)  # fmt: skip
MOST_BYTES = 1 << 20


def damaged(whole: bytes, chance: random.Random) -> bytes:
    """A few damages, one on top of the other."""
    data = bytearray(whole)
    for _ in range(chance.choice((1, 1, 2, 3, 8))):
        at = chance.randrange(len(data) + 1)
        length = min(len(data) - at, chance.choice((1, 2, 4, 8, 64, 1000)))
        kind = chance.randrange(7)
        if kind == 0 and at < len(data):
            data[at] ^= 1 << chance.randrange(8)
        elif kind == 1:
            del data[at : at + length]
        elif kind == 2:
            data[at:at] = data[at : at + length]
        elif kind == 3:
            data[at:at] = chance.choice(_NASTY)
        elif kind == 4:
            data[at : at + length] = chance.choice(_NASTY)
        elif kind == 5:
            data[at : at + length] = chance.randbytes(length)
        else:
            del data[at:]
    return bytes(data[:MOST_BYTES])
