"""Emergency stops that keep the bench from being armed."""

from __future__ import annotations

from collections.abc import Iterator

from drivers import Finding
from hil.core.errors import BenchError
from hil.engine.bench_tables import BenchFile
from hil.engine.emergency_stop import refuse_latched


def findings_of_stops(file: BenchFile) -> Iterator[Finding]:
    """The one that a run would be refused for."""
    try:
        refuse_latched(file)
    except BenchError as error:
        yield Finding("fault", error.what, error.where, error.fix)
