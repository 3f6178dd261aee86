"""Sign-ins under way: each can be finished once, soon, in the browser that began it."""

from __future__ import annotations

import hashlib
import secrets
import time
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Literal

#: Why somebody is not signed in: the page has a sentence for each.
Reason = Literal["late", "declined", "token", "no_role", "provider"]
#: A person types a password and a second factor meanwhile.
WITHIN_S = 600.0
MOST = 10_000


class SignInError(Exception):
    """No one is signed in; the words are for the log and have no secret."""

    def __init__(self, reason: Reason, words: str) -> None:
        super().__init__(words)
        self.reason = reason


def _random() -> str:
    return secrets.token_urlsafe(32)


@dataclass(frozen=True)
class Tried:
    """A sign-in under way.

    Attributes:
        state: comes back with the answer (RFC 6749, section 10.12).
        nonce: comes back in the ID token, which is of this sign-in then.
        verifier: of PKCE (RFC 7636): who intercepts the code cannot use it.
        browser: a secret in a cookie of the browser that began it.
        place: of the page to go on at.
        until_s: of the monotonic clock.
    """

    place: str
    until_s: float
    state: str = field(default_factory=_random, repr=False)
    nonce: str = field(default_factory=_random, repr=False)
    verifier: str = field(default_factory=_random, repr=False)
    browser: str = field(default_factory=_random, repr=False)


class TriedOnes:
    """Those that are under way; the oldest give way where there are too many."""

    def __init__(self) -> None:
        self._by_state: OrderedDict[str, Tried] = OrderedDict()

    def begin(self, place: str) -> Tried:
        """A new one."""
        tried = Tried(place=place, until_s=time.monotonic() + WITHIN_S)
        self._by_state[_hashed(tried.state)] = tried
        while len(self._by_state) > MOST:
            self._by_state.popitem(last=False)
        return tried

    def take(self, state: str, browser: str) -> Tried:
        """The one that an answer belongs to; it is over by that, whatever comes of it.

        Raises:
            SignInError: there is none, it is another browser's, it was finished before, or it is too old.
        """
        tried = self._by_state.pop(_hashed(state), None)
        if tried is None:
            raise SignInError("late", "no sign-in has this state, or it was finished before")
        if time.monotonic() > tried.until_s:
            raise SignInError("late", "the sign-in began too long ago")
        if not secrets.compare_digest(_hashed(browser), _hashed(tried.browser)):
            raise SignInError("late", "the sign-in began in another browser")
        return tried


def _hashed(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()
