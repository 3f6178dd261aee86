"""How much room recordings that people give may take."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from hil.api_schemas.recording import RecordingData
from hil.core.errors import BadInputError

_FIX = "remove recordings that are not needed"


@dataclass(frozen=True)
class Room:
    """Bounds of all recordings together; those that arrive count with their whole size.

    Attributes:
        most_bytes: of all of them.
        most_count: how many there may be.
        most_arriving: of one person.
        left_bytes: that stay free on the disk, for runs.
    """

    most_bytes: float = 100e9
    most_count: int = 1000
    most_arriving: int = 4
    left_bytes: float = 2e9

    def refuse_too_much(
        self, size: int, by: str, name: str, there: Sequence[RecordingData], folder: Path
    ) -> None:
        """Refuse a recording of `size` bytes that does not fit.

        Raises:
            BadInputError: there are too many, or too large ones, or the disk is too full.
        """
        arriving = [one for one in there if one.state == "arriving"]
        if len(there) >= self.most_count:
            raise BadInputError(f"there are {len(there)} recordings already", where=name, fix=_FIX)
        if sum(one.given_by == by for one in arriving) >= self.most_arriving:
            what = f"{self.most_arriving} recordings of {by} are still arriving"
            raise BadInputError(what, where=name, fix="complete or remove one of them first")
        taken = sum(one.size for one in there)
        if taken + size > self.most_bytes:
            left = max(0.0, self.most_bytes - taken)
            what = f"has {size / 1e6:.1f} MB; {left / 1e6:.1f} of {self.most_bytes / 1e6:.0f} MB are left"
            raise BadInputError(what, where=name, fix=f"{_FIX}, or start the service with --recordings-gb")
        to_come = sum(one.size - one.received for one in arriving)
        free = shutil.disk_usage(folder).free - to_come - self.left_bytes
        if size > free:
            what = f"has {size / 1e6:.1f} MB; the disk has {max(0.0, free) / 1e6:.1f} MB for recordings"
            raise BadInputError(what, where=name, fix=f"{_FIX}, or free disk space")
