"""Identifiers of SAE J1939-21: which frames are of a message that a DBC describes for any source address.

An identifier of 29 bits is priority (3), data page (2), PDU format (8), PDU specific (8), source address (8).
Format, page and, from format 240 on, the specific part are the parameter group number; below 240 that part is
a destination. A DBC of J1939 writes the null address 254 where every source is meant: no device has it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hil.core.can.dbc_messages import MessageLayout

NULL_ADDRESS = 0xFE
_SOURCE = 0xFF
_FIRST_BROADCAST_FORMAT = 240
_EXTENDED_BIT, _LARGEST = 1 << 31, 0x1FFF_FFFF


def group_of(identifier: int) -> int:
    """Parameter group number of an identifier of 29 bits."""
    whole = identifier >> 8 & 0x3FFFF
    return whole if identifier >> 16 & 0xFF >= _FIRST_BROADCAST_FORMAT else whole & ~0xFF


def for_addresses(
    layouts: Sequence[MessageLayout], keys: Iterable[int]
) -> tuple[list[MessageLayout], list[str]]:
    """Layouts with each message of any source address once for each that sends it, and what was found.

    Args:
        keys: of all frames, as `keys_of` gives them. A frame of which the DBC has the whole identifier is
            that message's alone.
    """
    there = set(keys)
    whole = {layout.key for layout in layouts if layout.key in there and not layout.any_address}
    by_group: dict[int, list[int]] = {}
    for key in sorted(there - whole):
        if _EXTENDED_BIT <= key <= _EXTENDED_BIT | _LARGEST:
            by_group.setdefault(group_of(key & ~_EXTENDED_BIT), []).append(key & ~_EXTENDED_BIT)
    found: list[MessageLayout] = []
    remarks: list[str] = []
    for layout in layouts:
        senders = by_group.pop(group_of(layout.id), []) if layout.any_address else []
        if not senders:
            found.append(layout)
            continue
        for identifier in senders:
            name = f"{layout.name}_{_address(identifier)}" if len(senders) > 1 else layout.name
            found.append(replace(layout, name=name, id=identifier))
        listed = ", ".join(f"0x{identifier & _SOURCE:02X}" for identifier in senders)
        remarks.append(f"message '{layout.name}' is of any source address in the DBC: sent by {listed}")
    return found, remarks


def of_other_addresses(layouts: Sequence[MessageLayout], unknown: Mapping[str, int]) -> list[str]:
    """Why frames of no message are not of one that the DBC has for another source address, a sentence each.

    Args:
        unknown: frames by identifier, 29 bits as "0x1234567x".
    """
    groups = {group_of(one.id): one for one in layouts if one.extended and one.is_j1939}
    remarks = []
    for text, count in unknown.items():
        if text.endswith("x") and (layout := groups.get(group_of(int(text[:-1], 16)))) is not None:
            address = f"0x{layout.id & _SOURCE:02X}"
            remarks.append(
                f"{count} frames {text} have the group of message '{layout.name}', which the DBC has for "
                f"address {address} alone: they are of no message (0xFE means any address)"
            )
    return remarks


def _address(identifier: int) -> str:
    return f"{identifier & _SOURCE:02X}"
