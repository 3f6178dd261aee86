"""What simulations may cost: how long a search goes on, and which outputs are kept to be asked for again.

An answer that says less is better than none. Fits and rankings ask for the same outputs again and again.
"""

from __future__ import annotations

import math
import time
from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from threading import Lock

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Places = npt.NDArray[np.int64]

_MOST_BYTES = 2e8
INTERRUPTED, OUT_OF_TIME = "interrupted", "out of time"
"""Why a search ended before it was through."""


class OutOfTimeError(Exception):
    """A search has used up what it was allowed."""


class Allowance:
    """Processor time of this process that a search may take, in s, from now on.

    Processor time and not the clock on the wall: a busy machine shall not change what is found.
    """

    def __init__(self, seconds: float = math.inf) -> None:
        self._ends = time.process_time() + seconds

    def check(self) -> None:
        """Go on, or not.

        Raises:
            OutOfTimeError: all of it is used up.
        """
        if time.process_time() > self._ends:
            raise OutOfTimeError

    def lift(self) -> None:
        """Let what comes now take as long as it takes."""
        self._ends = math.inf


#: For who may take as long as it takes.
UNBOUNDED = Allowance()


class Shown:
    """Outputs by what they follow from; the oldest ones are dropped. May be asked from several threads."""

    def __init__(self, most_bytes: float = _MOST_BYTES) -> None:
        self._kept: OrderedDict[Hashable, tuple[Array, object]] = OrderedDict()
        self._bytes, self._most = 0, most_bytes
        self._lock = Lock()

    def outputs(
        self,
        keys: Sequence[Hashable],
        simulate: Callable[[Places], Array],
        alive: object = None,
        *,
        keep: bool = True,
    ) -> Array:
        """Outputs of each key: sets x blocks x channels, not to be written to.

        Args:
            simulate: gives those of the places (k,) whose keys are not known.
            alive: what must not be forgotten as long as keys are known that name it by its identity.
            keep: whether new ones are worth it.
        """
        with self._lock:
            known = {key: self._kept[key][0] for key in keys if key in self._kept}
            for key in known:
                self._kept.move_to_end(key)
        places = dict.fromkeys(key for key in keys if key not in known)
        if len(keys) == 1 and known:
            return known[keys[0]][None]
        first = [keys.index(key) for key in places]
        new = simulate(np.array(first, dtype=np.int64)) if first else np.empty((0, 0, 0))
        new.setflags(write=False)
        found = dict(zip(places, new, strict=True))
        if keep:
            self._keep(found, alive)
        if len(first) == len(keys):
            return new
        found |= known
        return np.stack([found[key] for key in keys])

    def _keep(self, new: dict[Hashable, Array], alive: object) -> None:
        with self._lock:
            for key, one in new.items():
                if key not in self._kept:
                    self._kept[key] = one, alive
                    self._bytes += one.nbytes
            while self._bytes > self._most:
                self._bytes -= self._kept.popitem(last=False)[1][0].nbytes
