"""What people give is read by another process, which is ended if it takes too long; a next one reads on."""

from __future__ import annotations

import asyncio

import pytest

from hil.core.errors import BadInputError
from hil.service.worker_pool import TooLongError, WorkerPool
from test_plans import library_controllers
from tests.hil.service.attacks import DOTTED

ENDLESS = "name: long\nsteps:\n" + "  - wait: {duration_s: 1}\n" * 15_000


@pytest.mark.slow
def test_what_takes_too_long_ends_the_process_that_reads_it_and_the_next_is_read() -> None:
    async def ask() -> None:
        worker_pool = WorkerPool(niceness=0, read_within_s=0.5)
        try:
            with pytest.raises(TooLongError):
                await worker_pool.ask("read_plan", name="long", text=ENDLESS, folder="/")
            with pytest.raises(BadInputError, match="more than 32 parts"):
                await worker_pool.ask("read_model", name="dotted", text=DOTTED)
            text = library_controllers()["phase_stabilization"].read_text()
            assert await worker_pool.ask("read_controller", name="mine", text=text) == {}
        finally:
            process = worker_pool._process
            worker_pool.close()
            if process is not None:
                await process.wait()

    asyncio.run(ask())
