"""The options of each command, one class a command, by topic; light, so that --help answers at once."""

from hil.cli.options.benches import (
    BenchAgent,
    BenchDoctor,
    BenchJog,
    BenchMonitor,
    BenchReset,
    BenchSim,
    Serve,
)
from hil.cli.options.controllers import Autotune, Campaign, Design, Tune
from hil.cli.options.files import EvidenceRecover, EvidenceSign, EvidenceVerify, Init, List, Schema
from hil.cli.options.models import Diagnose, Explain, Identify, Simulate
from hil.cli.options.runs import Check, Compare, Export, Replay, Report, Run

__all__ = [
    "Autotune",
    "BenchAgent",
    "BenchDoctor",
    "BenchJog",
    "BenchMonitor",
    "BenchReset",
    "BenchSim",
    "Campaign",
    "Check",
    "Compare",
    "Design",
    "Diagnose",
    "EvidenceRecover",
    "EvidenceSign",
    "EvidenceVerify",
    "Explain",
    "Export",
    "Identify",
    "Init",
    "List",
    "Replay",
    "Report",
    "Run",
    "Schema",
    "Serve",
    "Simulate",
    "Tune",
]
