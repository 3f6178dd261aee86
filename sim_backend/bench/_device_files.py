"""Files of devices that a simulated bench can be made of."""

from __future__ import annotations

from pathlib import Path

from hil.core.can.dbc import Names, read_dbc
from sim_backend.rcs import read_node
from sim_backend.rmcu import NEEDED


def check_device_files(dbc: Path, eds: Path, names: Names | None = None) -> None:
    """Refuse a DBC, which calls things by `names`, or an EDS that no simulated bench can be made of.

    Raises:
        BadInputError: file and what it lacks.
    """
    read_dbc(dbc, NEEDED, names)
    read_node(eds, 1)
