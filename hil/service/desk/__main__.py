"""`python -m hil.service.desk`: answers the service's questions until it has none; nobody else starts it."""

from __future__ import annotations

import json
import logging
import os
import select
import sys
from collections.abc import Callable
from typing import Any

from hil.core.errors import BadInputError, HilError
from hil.service.desk import _comparing

_IDLE_S = 600.0
TASKS: dict[str, Callable[..., dict[str, Any]]] = {
    "comparison": _comparing.comparison,
    "traces": _comparing.traces,
}


def main() -> None:
    """Answer line by line; end with the service, or after ten minutes without a question."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no answer
    while select.select([0], [], [], _IDLE_S)[0]:
        line = sys.stdin.buffer.readline()
        if not line:
            return
        answers.write(json.dumps(_answer(json.loads(line)), allow_nan=False).encode() + b"\n")
        answers.flush()


def _answer(question: dict[str, Any]) -> dict[str, Any]:
    try:
        return {"answer": TASKS[question["task"]](**question["asked"])}
    except HilError as error:
        bad = isinstance(error, BadInputError)
        return {"refused": {"what": error.what, "where": error.where, "fix": error.fix, "bad_input": bad}}
    except Exception as error:
        logging.getLogger(__name__).exception("internal error")
        what = f"internal error: {type(error).__name__}: {error}"
        return {"refused": {"what": what, "where": question["task"], "fix": "", "bad_input": False}}


if __name__ == "__main__":
    main()
