"""A run: pre-flight, arm, carry out, safe state, record."""

from hil.engine.bench_file import DEFAULT_BENCH, load_bench
from hil.engine.bench_tables import BenchFile
from hil.engine.ipc import RECORDING, RunOutcome, RunRequest
from hil.engine.run import run_plan
from hil.engine.stopping import StopRequest
from hil.engine.supervisor import carry_out

__all__ = [
    "DEFAULT_BENCH",
    "RECORDING",
    "BenchFile",
    "RunOutcome",
    "RunRequest",
    "StopRequest",
    "carry_out",
    "load_bench",
    "run_plan",
]
