"""Why simulation and measurement differ: effects that a model lacks, found by name in recordings."""

from hil.analysis.diagnosis._diagnose import diagnose
from hil.analysis.diagnosis.data._gap import BANDS_HZ, CONDITIONS, ChannelGap, GapMap
from hil.analysis.diagnosis.data._sanity import examine
from hil.analysis.diagnosis.data._thresholds import LEAST_SAMPLES
from hil.analysis.diagnosis.data._trace import unbroken
from hil.analysis.diagnosis.search._thresholds import BOOTSTRAP_DRAWS
from hil.analysis.diagnosis.tell._consequences import why_no_step
from hil.analysis.diagnosis.tell._result import (
    INTERRUPTED,
    Alternative,
    Considered,
    Diagnosis,
    NamedEffect,
    Overlay,
)
from hil.analysis.diagnosis.tell._words import Where

__all__ = [
    "BANDS_HZ",
    "BOOTSTRAP_DRAWS",
    "CONDITIONS",
    "INTERRUPTED",
    "LEAST_SAMPLES",
    "Alternative",
    "ChannelGap",
    "Considered",
    "Diagnosis",
    "GapMap",
    "NamedEffect",
    "Overlay",
    "Where",
    "diagnose",
    "examine",
    "unbroken",
    "why_no_step",
]
