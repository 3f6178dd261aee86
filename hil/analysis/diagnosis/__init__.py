"""Why simulation and measurement differ: effects that a model lacks, found by name in recordings."""

from hil.analysis.diagnosis._diagnose import diagnose
from hil.analysis.diagnosis.data.gap import BANDS_HZ, CONDITIONS, ChannelGap, GapMap
from hil.analysis.diagnosis.data.sanity import examine
from hil.analysis.diagnosis.findings.consequences import why_no_step
from hil.analysis.diagnosis.findings.named import Where
from hil.analysis.diagnosis.findings.result import (
    Alternative,
    Diagnosis,
    NamedEffect,
    Overlay,
)
from hil.analysis.diagnosis.findings.separating import NO_TEST
from hil.analysis.missing_effects import INTERRUPTED, Curve
from hil.analysis.stretches import LEAST_SAMPLES

__all__ = [
    "BANDS_HZ",
    "CONDITIONS",
    "INTERRUPTED",
    "LEAST_SAMPLES",
    "NO_TEST",
    "Alternative",
    "ChannelGap",
    "Curve",
    "Diagnosis",
    "GapMap",
    "NamedEffect",
    "Overlay",
    "Where",
    "diagnose",
    "examine",
    "why_no_step",
]
