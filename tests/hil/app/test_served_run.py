"""What a run of a service tells of itself."""

from __future__ import annotations

import logging
from typing import Any

from hil.app.worker import served_run
from hil.engine.ipc.ipc_messages import Progressed


class _Pipe:
    """Takes what is sent."""

    crowded = False

    def __init__(self) -> None:
        self.sent: list[Any] = []

    def send(self, message: Any) -> None:
        self.sent.append(message)


def test_the_page_is_told_that_the_simulation_is_being_compiled() -> None:
    pipe: Any = _Pipe()
    compiler = logging.getLogger("hil.core.runtime.compiled")
    compiler.setLevel(logging.INFO)
    with served_run._Service(pipe, None).progress("plan") as show:
        show("s", 0.0)
        compiler.info("compiling %s.%s", "module", "function")
        show("s", 0.5)
    compiler.info("compiling %s.%s", "module", "another")  # no run waits for it
    told = Progressed(share=-1.0, text="compiling for this machine, once: a minute or two")
    assert pipe.sent == [Progressed(share=0.0, text="s"), told, Progressed(share=0.5, text="s")]
