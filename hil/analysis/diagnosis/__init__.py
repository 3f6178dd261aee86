"""Why simulation and measurement differ: effects that a model lacks, found by name in recordings."""

from hil.analysis.diagnosis._diagnose import diagnose
from hil.analysis.diagnosis.data.gap import BANDS_HZ, CONDITIONS, ChannelGap, GapMap
from hil.analysis.diagnosis.data.sanity import examine
from hil.analysis.diagnosis.data.thresholds import LEAST_SAMPLES
from hil.analysis.diagnosis.search.thresholds import BOOTSTRAP_DRAWS
from hil.analysis.diagnosis.tell.consequences import why_no_step
from hil.analysis.diagnosis.tell.result import (
    INTERRUPTED,
    Alternative,
    Considered,
    Diagnosis,
    NamedEffect,
    Overlay,
)
from hil.analysis.diagnosis.tell.words import Where

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
    "why_no_step",
]
