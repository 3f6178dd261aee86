"""What is asked of each use case, as it passes from a command, a page or a file.

Light: whoever only asks needs none of the analysis. Where no folder is named for results, a new one is
numbered.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from test_plans import Choices

if TYPE_CHECKING:
    from hil.analysis.control_design import DesignSpec


@dataclass(frozen=True, kw_only=True)
class _Writing:
    """What has results: `out` is the folder for them, and `overwrite` replaces an earlier result in it."""

    out: Path | None = None
    overwrite: bool = False


@dataclass(frozen=True, kw_only=True)
class CheckRequest:
    """A plan and a bench, each by file or name, and what is chosen in place of the plan's own values."""

    plan: str
    bench: str
    choices: Choices = field(default_factory=Choices)


@dataclass(frozen=True, kw_only=True)
class ReportRequest(_Writing):
    """A report that is wanted; `source` is a run's folder or a recording, `out` by default its folder.

    Attributes:
        columns: which column of another tool's file is which channel, as options have it.
    """

    source: Path
    columns: Sequence[str] | None = None


@dataclass(frozen=True, kw_only=True)
class CompareRequest(_Writing):
    """A comparison that is wanted; `runs` are folders or recordings, the first is the reference."""

    runs: list[Path]


@dataclass(frozen=True, kw_only=True)
class IdentifyRequest(_Writing):
    """An identification that is wanted.

    Attributes:
        segments: ids of segments to use; none for every chirp and multisine.
        hold_ms: zero-order hold of the input; None for the sample time, at most 1 ms.
        columns: which column of another tool's file is which channel, as options have it.
    """

    recordings: list[Path]
    segments: Sequence[str] | None = None
    input_channel: str = "motor_torque_ref_nm"
    from_hz: float | None = None
    to_hz: float | None = None
    method: str = "auto"
    order: int | None = None
    gear_ratio: float | None = None
    hold_ms: float | None = None
    columns: Sequence[str] | None = None


@dataclass(frozen=True, kw_only=True)
class DesignRequest(_Writing):
    """A design that is wanted.

    Attributes:
        spec: None for the paper's choices.
        frf: measured responses; None for frf.csv beside the model, if it is there.
    """

    model: Path
    spec: DesignSpec | None = None
    frf: Path | None = None


@dataclass(frozen=True, kw_only=True)
class DiagnoseRequest(_Writing):
    """A diagnosis that is wanted.

    Attributes:
        holdout: recordings for validation, not used in any fit.
        noise: standard deviation of a channel's samples, by channel.
        least: smallest relevant size of an effect, by its id.
        at_most: minutes of processor time of the search.
        columns: which column of another tool's file is which channel, as options have it.
    """

    recordings: list[Path]
    model: Path
    holdout: Sequence[Path] | None = None
    noise: Mapping[str, float] = field(default_factory=dict)
    least: Mapping[str, float] = field(default_factory=dict)
    at_most: float = 10.0
    columns: Sequence[str] | None = None


@dataclass(frozen=True, kw_only=True)
class ExplainRequest(_Writing):
    """An explanation that is wanted.

    Attributes:
        plan: file or name; None for that of the targets file, or acceptance.
        bench: a simulated one, by file or name.
        targets: file with the figures to be reached; `figures` come on top, by their names.
        model: to start from; None for the bench's own.
        among: effects and parameters that may change; none for all.
    """

    plan: str | None = None
    bench: str
    targets: Path | None = None
    figures: Mapping[str, float] = field(default_factory=dict)
    model: Path | None = None
    among: Sequence[str] | None = None
    evaluations: int = 2000
    seed: int = 0


@dataclass(frozen=True, kw_only=True)
class SearchRequest:
    """A search that is wanted.

    Attributes:
        plan, bench: file or name.
        free: file with free parameters, weights, hard limits and tolerances; None for the shipped one.
        controller: the plan's name for the controller that is tuned; '' for the last one.
        start: controller file to start from; None for the plan's own.
        draws: cars sampled around the model.
        may_worsen: what may get worse than with the start (KEPT of hil.analysis.tuning), beside the file's.
    """

    plan: str
    model: Path
    bench: str
    free: Path | None = None
    controller: str = ""
    start: Path | None = None
    draws: int = 0
    seed: int = 0
    may_worsen: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class TuneRequest(_Writing):
    """A tuning that is wanted.

    Attributes:
        starts: further starting points of the search.
        at_most: minutes after which the search ends with what it has.
        processes: predictions at once; None for one a processor.
        refine: refine on the bench of `search`, with at most `runs` runs within `envelope`.
        differ: deviation of the first run from its prediction above which it is diagnosed, per cent of a
            criterion's limit.
        confirm: who consents to these runs; '' if the person at the terminal is asked.
    """

    search: SearchRequest
    starts: int = 6
    at_most: float | None = None
    processes: int | None = None
    refine: bool = False
    differ: float = 5.0
    runs: int | None = None
    envelope: Mapping[str, float] = field(default_factory=dict)
    confirm: str = ""
    operator: str = ""


@dataclass(frozen=True, kw_only=True)
class AutotuneRequest(_Writing):
    """A sequence that is wanted.

    Attributes:
        sequence: file, or the name of a shipped one.
        bench: file or name.
        envelope: largest magnitudes allowed in a run, by channel.
        confirm: who consents to the runs; '' if the person at the terminal is asked.
        processes: predictions at once; None for one a processor.
        resume: go on with what lies in `out`.
    """

    sequence: str
    model: Path
    bench: str
    envelope: Mapping[str, float] = field(default_factory=dict)
    confirm: str = ""
    operator: str = ""
    processes: int | None = None
    resume: bool = False


@dataclass(frozen=True, kw_only=True)
class CampaignRequest(_Writing):
    """A campaign that is wanted.

    Attributes:
        campaign: file, or the name of a shipped one.
        workers: processes that simulate; 0 for this one alone, None for one a processor.
        scheduler: address of a dask scheduler that has workers, or ''.
        resume: go on with what lies in `out`.
    """

    campaign: str
    workers: int | None = None
    scheduler: str = ""
    resume: bool = False

    @property
    def processes(self) -> int:
        """How many simulate at once here, this one included."""
        return max(1, len(os.sched_getaffinity(0)) if self.workers is None else self.workers)
