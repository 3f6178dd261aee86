"""A call executed by a process of its own, which can be killed and takes no time of this one's threads.

`python -m hil.core.runtime.other_process` is that process: it reads a call from its standard input, and
writes what the call gave, or the error that it raised, to its standard output, both pickled.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from hil.core.errors import BenchError, HilError

_POLITE = 5  # added to its nice value: who started it has a bench to keep alive
_LAST_WORDS = 500
_LOOK_S = 1.0


class OtherProcess:
    """A call that is being executed; the function and its arguments must be picklable."""

    def __init__(self, function: Callable[..., Any], *arguments: object) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", __name__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            start_new_session=True,  # Ctrl-C is for who started it
        )
        self._answer: tuple[bool, Any] | None = None
        self._failure: Exception | None = None
        # Only bytes are moved there: the interpreter's lock is free while they are.
        self._thread = threading.Thread(target=self._talk, args=((function, arguments),), daemon=True)
        self._thread.start()

    def done(self) -> bool:
        """Whether it has ended; never waits."""
        return not self._thread.is_alive()

    def result(self) -> Any:
        """What the call gave; waits for it.

        Raises:
            BenchError: the process ended without an answer, or the call raised what is no HilError.
            HilError: what the call raised.
        """
        self._thread.join()
        if self._failure is not None:
            raise BenchError(f"internal error: {self._failure}", where="analysis", fix="please report it")
        assert self._answer is not None
        well, value = self._answer
        if not well:
            raise value
        return value

    def kill(self) -> None:
        """End it at once; what it was doing is lost."""
        self._process.kill()

    def _talk(self, call: tuple[Callable[..., Any], tuple[object, ...]]) -> None:
        process = self._process
        assert process.stdin is not None
        with process:
            try:
                with contextlib.suppress(BrokenPipeError):  # then its standard error says why
                    pickle.dump(call, process.stdin, protocol=5)
                out, complaint = process.communicate()
                self._answer = pickle.loads(out) if out else self._gone(complaint)
            except Exception as error:
                self._failure = error
                process.kill()

    def _gone(self, complaint: bytes) -> tuple[bool, HilError]:
        words = complaint.decode(errors="replace").strip()[-_LAST_WORDS:]
        what = f"the process ended with code {self._process.returncode}"
        what = f"{what}: {words}" if words else what
        return False, BenchError(what, where="analysis", fix="is there enough memory?")


def _carried_out() -> tuple[bool, Any]:
    try:
        function, arguments = pickle.load(sys.stdin.buffer)
        return True, function(*arguments)
    except HilError as error:
        return False, error
    except Exception as error:
        what = f"internal error: {type(error).__name__}: {error}"
        return False, BenchError(what, where="analysis", fix="please report it")


def end_with_parent(parent: int) -> None:
    """No one waits for an answer any more once the process that asked has ended, however it did."""
    while os.getppid() == parent:
        time.sleep(_LOOK_S)
    os._exit(1)


def main() -> None:
    """Be that process."""
    threading.Thread(target=end_with_parent, args=(os.getppid(),), daemon=True).start()
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no answer
    with contextlib.suppress(OSError, AttributeError):
        os.nice(_POLITE)
    pickle.dump(_carried_out(), answer, protocol=5)
    answer.close()


if __name__ == "__main__":
    main()
