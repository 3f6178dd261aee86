"""A run: pre-flight, arm, carry out, safe state, record."""

from hil.engine.bench import Bench, open_bench
from hil.engine.bench_file import DEFAULT_BENCH, BenchFile, load_bench
from hil.engine.run import RECORDING, RunOutcome, RunRequest, run_plan

__all__ = [
    "DEFAULT_BENCH",
    "RECORDING",
    "Bench",
    "BenchFile",
    "RunOutcome",
    "RunRequest",
    "load_bench",
    "open_bench",
    "run_plan",
]
