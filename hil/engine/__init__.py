"""A run: pre-flight, arm, execute, safe state, record."""

from hil.engine.bench.bench_file import DEFAULT_BENCH, load_bench
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.ipc.ipc import RECORDING, RunOutcome, RunRequest
from hil.engine.process.supervisor import execute
from hil.engine.run.run import run_plan
from hil.engine.stop.stopping import StopRequest

__all__ = [
    "DEFAULT_BENCH",
    "RECORDING",
    "BenchFile",
    "RunOutcome",
    "RunRequest",
    "StopRequest",
    "execute",
    "load_bench",
    "run_plan",
]
