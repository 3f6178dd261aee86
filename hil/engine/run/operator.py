"""The person at the bench as the loop sees them: informed and asked without ever waiting for them."""

from __future__ import annotations

import time
from collections.abc import Callable

from drivers import BusLoop
from hil.core.errors import EmergencyStopError, InterruptError
from hil.engine.ipc.ipc import Terminal
from hil.engine.ipc.ipc_messages import EmergencyAsked, Question

#: Of the clock on the wall, s: what comes sooner after an emergency stop is the same one, by another way.
SAME_STOP_S = 1.0
LOOK_S = 0.02  # how often it is looked whether a line was typed
_VIRTUAL_TICK_S = 0.01  # what passes at once while no one has to be awaited
PAUSE, RESUME, END, EMERGENCY = "p", "r", "q", "e"
#: End of transmission (ASCII), which no person types: the service or agent that executed the run has gone.
GONE = "\x04"
GONE_REASON = "the service or agent that executed the run ended"


class Operator:
    """Takes lines from a terminal: p holds the run, r lets it go on, q ends it, e is an emergency stop.

    Args:
        terminal: None: no one is there.
        confirmed_by: who confirmed every prompt beforehand.
        standing: called again and again while virtual time stands still, in which no loop turns.
    """

    def __init__(
        self,
        loop: BusLoop,
        terminal: Terminal | None,
        confirmed_by: str,
        standing: Callable[[], None] = lambda: None,
    ) -> None:
        self._loop, self._terminal, self._confirmed_by = loop, terminal, confirmed_by
        self._standing = standing
        self._wants_pause = self._wants_to_go_on = False
        self._answer: str | None = None
        self._stopped_s: float | None = None

    @property
    def present(self) -> bool:
        """Whether somebody can answer."""
        return self._terminal is not None

    def tell(self, text: str) -> None:
        """Show a text, if anybody is there."""
        if self._terminal is not None:
            self._terminal.tell(text)

    def look(self) -> None:
        """Take what was typed since the last look; never waits.

        An emergency stop counts once: one that is repeated, by the same or another way, does not disturb
        what makes the bench safe; one that comes later asks that nothing more is waited for.

        Raises:
            EmergencyStopError: somebody asked for it.
        """
        for line in self._terminal.typed() if self._terminal is not None else ():
            if isinstance(line, EmergencyAsked):
                self._stop(line.as_error())
                continue
            word = line.strip().lower()
            if word == EMERGENCY:
                self._stop(typed_emergency())
                continue
            if word == GONE:
                self._loop.stop_reason = GONE_REASON
            self._loop.stop_requested |= word in (END, GONE)
            self._wants_pause |= word == PAUSE
            self._wants_to_go_on |= word == RESUME
            self._answer = line.strip()

    def _stop(self, error: EmergencyStopError) -> None:
        now_s = time.monotonic()
        if self._stopped_s is None:
            self._stopped_s = now_s
            raise error
        if now_s - self._stopped_s > SAME_STOP_S:
            self._loop.stop_requested = True

    def take_pause(self) -> bool:
        """Whether a pause was asked for since the last call."""
        asked, self._wants_pause = self._wants_pause, False
        return asked

    def take_resume(self) -> bool:
        """Whether somebody released the run since the last call."""
        asked, self._wants_to_go_on = self._wants_to_go_on, False
        return asked

    def pass_time(self) -> None:
        """Let a little bench time pass; in virtual time, where somebody is there, no faster than they live.

        Raises:
            InterruptError: the run is to be ended.
            EmergencyStopError: somebody asked for it.
        """
        if not self._loop.clock.virtual:
            self._loop.step()
        elif self._terminal is None:
            self._loop.run_for(_VIRTUAL_TICK_S)
        else:
            self._stand_still()
            self._loop.run_for(LOOK_S)

    def wait_for(self, done: Callable[[], bool], timeout_s: float) -> bool:
        """Keep heartbeats going until `done`; False if it is not within `timeout_s`.

        In virtual time the clock stands still meanwhile: how long a person takes changes no result.

        Raises:
            InterruptError: the run is to be ended.
            EmergencyStopError: somebody asked for it.
        """
        virtual = self._loop.clock.virtual
        now_s = time.monotonic if virtual else self._loop.clock.now_s
        until_s = now_s() + timeout_s
        while not done():
            if now_s() > until_s:
                return False
            if virtual:
                self._stand_still()
            else:
                self._loop.step()
            self._refuse_when_stopped()
        return True

    def confirm(self, text: str, timeout_s: float, picture: str = "") -> str:
        """Have a prompt confirmed; says by whom or by what.

        Raises:
            InterruptError: the run is to be ended, or no one answered in time.
            EmergencyStopError: somebody asked for it.
        """
        if self._confirmed_by:
            return f"confirmed in advance by {self._confirmed_by}"
        if self._terminal is None:
            return "no operator: a simulated bench continues"
        self.look()  # a line that was typed before is no answer
        self._answer = None
        how = "Press Enter to continue, q and Enter to end the run. Other text is a remark: the run goes on."
        question = Question(text=text, answer_within_s=timeout_s, picture=picture)
        self._terminal.tell(f"{text}\n{how}", question)
        if not self._is_answered(text, timeout_s):
            what = f"no answer to '{text}' within {timeout_s:g} s"
            raise InterruptError(what, where="operator prompt")
        self.take_pause()  # at a prompt the run is held already
        remark = f"; remark: {self._answer}" if self._answer else ""
        return f"confirmed by the operator{remark}"

    def _is_answered(self, text: str, timeout_s: float) -> bool:
        try:
            return self.wait_for(lambda: self._answer is not None, timeout_s)
        except InterruptError as error:
            if self._loop.stop_reason == GONE_REASON:
                raise
            raise InterruptError(f"stopped by the operator, who did not continue at '{text}'") from error

    def _stand_still(self) -> None:
        time.sleep(LOOK_S)
        self._standing()
        self.look()
        self._refuse_when_stopped()

    def _refuse_when_stopped(self) -> None:
        """Also where the end steps are shielded: a person who is asked may decline."""
        if self._loop.stop_requested:
            self._loop.stop_requested = False
            raise InterruptError(self._loop.stop_reason)


def typed_emergency() -> EmergencyStopError:
    """The emergency stop of who sits at the run's terminal."""
    return EmergencyStopError("the operator typed e", by="the operator", origin="terminal", way="terminal")
