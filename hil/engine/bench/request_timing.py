"""When periodic requests were meant, sent and seen on the bus: recorded, and summed up without growing."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from drivers import Device, Wire
from drivers.echoes import Echo
from hil.core.result import Lateness, PeriodicRequests
from hil.core.runtime.clock import Clock

Times: TypeAlias = npt.NDArray[np.float64]
#: Takes name, bench time (s) and the times meant, sent and seen (NaN: not seen), s, shape (3, n).
Record: TypeAlias = Callable[[str, float, Times], None]

COLLECT_S = 0.1  # how often what waits is summed up and recorded; short, for nothing is sent meanwhile
_GIVEN_UP_S = 0.25  # an echo that has not come by then does not come
_BIN_S, _BINS = 2e-6, 50_000  # of a histogram: 0 to 0.1 s
_NOT_SEEN = np.nan


class RequestTiming:
    """The periodic requests of a bench in wall-clock time.

    In each cycle an entry is appended to a list, no more; every `COLLECT_S` the lists are summed up, recorded
    and emptied, so that memory does not grow with the length of a run.

    Args:
        wires: of the bench, by name; where own frames come back they tell when a request was seen.
    """

    def __init__(self, clock: Clock, wires: Sequence[Wire], record: Record) -> None:
        self._clock, self._record = clock, record
        self._wires = {wire.name: wire for wire in wires}
        self._periodic: list[Periodic] = []

    def of(self, device: Device, bus: str | None, request: str, period_s: float) -> Periodic:
        """What notes the cycles of one request; `bus`: the one that it goes out on, if it is a CAN bus."""
        made = Periodic(self._clock, self._wires.get(bus or ""), request, device.name, period_s)
        self._periodic.append(made)
        return made

    def collect(self, *, everything: bool = False) -> None:
        """Sum up and record what has been noted; `everything`: nothing more will come.

        Raises:
            BenchError: it cannot be recorded.
        """
        now_s = self._clock.now_s()
        echoes = {name: wire.echoes.fetch() for name, wire in self._wires.items() if wire.echoes}
        for periodic in self._periodic:
            seen = echoes.get(periodic.wire.name, []) if periodic.wire else []
            times = periodic.settled(seen, np.inf if everything else now_s - _GIVEN_UP_S)
            if times.shape[1]:
                self._record(f"{periodic.device}: {periodic.request}", now_s, times)

    def results(self) -> tuple[PeriodicRequests, ...]:
        """What came of each request that was sent at all."""
        return tuple(periodic.result() for periodic in self._periodic if periodic.count)


class Periodic:
    """One request's cycles: `noted` after each was sent."""

    def __init__(self, clock: Clock, wire: Wire | None, request: str, device: str, period_s: float) -> None:
        self.wire, self.request, self.device = wire, request, device
        self._clock, self._period_s = clock, period_s
        self._waiting: deque[tuple[float, float, int, int]] = deque()  # meant, sent, identifier and payload
        self._last_meant_s = np.nan
        self._sent, self._seen = _Histogram(), _Histogram()
        self.count = self._missed = self._unseen = 0

    def noted(self, meant_s: float) -> None:
        """The request has just been sent that was meant for `meant_s`."""
        sent = self.wire.last_sent if self.wire else None
        self._waiting.append((meant_s, *(sent or (self._clock.now_s(), -1, 0))))

    def rest(self) -> None:
        """No request is due for a while: what is not sent now is not missed."""
        self._waiting.append((np.nan, np.nan, -1, 0))

    def settled(self, echoes: Sequence[Echo], until_s: float) -> Times:
        """Times of the requests that were seen, or were sent before `until_s` and never will be, (3, n)."""
        rows: list[tuple[float, float, float]] = []
        waiting = self._waiting
        wanted = {entry[2:] for entry in waiting}
        for echo in echoes:
            if echo[1:] not in wanted:
                continue
            while waiting:
                meant_s, sent_s, *frame = waiting.popleft()
                is_it = tuple(frame) == echo[1:]
                rows.append((meant_s, sent_s, echo.time_s if is_it else _NOT_SEEN))
                if is_it:
                    break
        shown = self.wire is not None and self.wire.echoes is not None
        while waiting and not (shown and waiting[0][1] > until_s):
            rows.append((*waiting.popleft()[:2], _NOT_SEEN))
        times = np.array(rows).reshape(-1, 3).T
        self._sum_up(times)
        return times[:, np.isfinite(times[0])]

    def _sum_up(self, times: Times) -> None:
        if not times.shape[1]:
            return
        meant_s = np.concatenate([[self._last_meant_s], times[0]])
        self._last_meant_s = float(meant_s[-1])
        apart = np.rint(np.diff(meant_s) / self._period_s)  # NaN after a rest
        self._missed += int(np.sum(apart[apart > 1] - 1))
        meant_s, sent_s, seen_s = times[:, np.isfinite(times[0])]
        late_s = sent_s - meant_s
        # Left out, or so late that the next one was due
        self._missed += int(np.count_nonzero(late_s >= self._period_s))
        self.count += len(meant_s)
        self._sent.add(late_s)
        if self.wire is not None and self.wire.echoes is not None:
            was_seen = np.isfinite(seen_s)
            self._unseen += int(np.count_nonzero(~was_seen))
            self._seen.add((seen_s - meant_s)[was_seen])

    def result(self) -> PeriodicRequests:
        """What came of it so far."""
        return PeriodicRequests(
            request=self.request,
            device=self.device,
            period_s=self._period_s,
            count=self.count,
            missed=self._missed,
            sent=self._sent.lateness(),
            seen=self._seen.lateness() if self._seen.any else None,
            unseen=self._unseen,
        )


class _Histogram:
    """How often something was how late: percentiles to 2 us, of any number of values."""

    def __init__(self) -> None:
        self._counts = np.zeros(_BINS, np.int64)
        self._largest_s = 0.0

    @property
    def any(self) -> bool:
        return bool(self._counts.any())

    def add(self, late_s: Times) -> None:
        if len(late_s):
            bins = np.clip(late_s / _BIN_S, 0, _BINS - 1).astype(np.int64)
            np.add.at(self._counts, bins, 1)
            self._largest_s = max(self._largest_s, float(np.max(late_s)))

    def lateness(self) -> Lateness:
        below = np.cumsum(self._counts)
        found = [int(np.searchsorted(below, share * below[-1])) for share in (0.5, 0.99)]
        p50_s, p99_s = (min((at + 0.5) * _BIN_S, self._largest_s) if at < _BINS - 1 else self._largest_s
                        for at in found)  # fmt: skip
        return Lateness(p50_ms=_ms(p50_s), p99_ms=_ms(p99_s), max_ms=_ms(self._largest_s))


def _ms(seconds: float) -> float:
    return round(1e3 * seconds, 3)
