"""Emergency stops that keep the bench from being armed."""

from __future__ import annotations

from collections.abc import Iterator

from drivers import Finding
from hil.core.errors import BenchError
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.stop.emergency_stop import refuse_latched
from hil.engine.stop.stop_places import remark_on_place


def findings_of_stops(file: BenchFile) -> Iterator[Finding]:
    """The one that a run is refused for; and where one would be kept, if others may not find it there."""
    try:
        refuse_latched(file)
    except BenchError as error:
        yield Finding("fault", error.what, error.where, error.fix)
    remark = remark_on_place(file)
    if remark:
        what, _, fix = remark.partition("; ")
        yield Finding("hint", what, f"bench '{file.name}'", fix)
