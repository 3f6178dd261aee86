"""How fast the motor of a bench turns, asked of a process that only listens."""

from __future__ import annotations

import asyncio
import json
from dataclasses import dataclass
from pathlib import Path

from hil.app.worker.motor_speed import MOTOR_SPEED
from hil.execution.background import output_of, start_process

_NICENESS = 5
_WITHIN_S = 30.0


@dataclass(frozen=True)
class Heard:
    """A motor's speed, rad/s; None, with the reason `why`, where it could not be heard.

    `final`: nor can it be later.
    """

    speed_rad_s: float | None
    why: str = ""
    final: bool = False


def only_listens(process: str) -> bool:
    """Whether a process, by its command, only listens: it is a service's own, and ends by itself."""
    return MOTOR_SPEED[-1] in process


async def hear_motor_speed(bench: Path) -> Heard:
    """Listen to the bench of a file for a moment; nothing is sent.

    Raises:
        OSError: the process cannot be started.
    """
    process = await start_process(
        *MOTOR_SPEED,
        str(bench),
        niceness=_NICENESS,
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.DEVNULL,
    )
    try:
        answer, _ = await output_of(process, _WITHIN_S)
        return Heard(**{"speed_rad_s": None, **json.loads(answer)})
    except TimeoutError:
        return Heard(None, f"took more than {_WITHIN_S:g} s")
    except ValueError:
        return Heard(None, f"its process ended with code {process.returncode}")
