"""Answers about runs that are over, from what was kept of each; where nothing was, it is made now."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from hil.core.recording import Overview, overview_of, read_overview, write_overview
from hil.service.worker_pool import run_view

_KEPT = 8  # overviews that stay open


def overview(folder: str, recording: str) -> dict[str, Any]:
    """Nothing, once the overview of a recording is in its folder.

    Raises:
        BadInputError: there is no sample in it.
    """
    _overview(folder, recording)
    return {}


def spectrum(folder: str, recording: str, **asked: Any) -> dict[str, Any]:
    """Fields of `RunSpectrum`.

    Raises:
        BadInputError: as of `spectrum_of`.
    """
    return run_view.spectrum_of(_overview(folder, recording), Path(recording), **asked)


def samples(folder: str, recording: str, **asked: Any) -> dict[str, Any]:
    """Fields of `RunSamples`.

    Raises:
        BadInputError: as of `samples_of`.
    """
    return run_view.samples_of(_overview(folder, recording), Path(recording), **asked)


@functools.lru_cache(_KEPT)
def _overview(folder: str, recording: str) -> Overview:
    """The one that was made when the run was recorded, else made now and kept."""
    found = read_overview(Path(folder))
    if found is None:
        write_overview(overview_of(Path(recording)), Path(folder))
        found = read_overview(Path(folder))
        assert found is not None, "it was just written"
    return found
