"""Benches: their states, stops, and who has one for themselves."""

from __future__ import annotations

import datetime

from hil.api_schemas.api import BenchData, Health, LeaseData, LeaseWanted, ReservationData, RunData
from hil.api_schemas.team import HandoverData, HandoverWanted, ReservationWanted
from hil.client._requests import WITHIN_S, Requests, first_of, part
from hil.core.errors import BenchError


class BenchRequests(Requests):
    """Benches: their states, stops, and who has one for themselves."""

    _stop_url = ""

    def health(self) -> Health:
        """Whether it works."""
        return self._one(Health, "GET", "/health")

    def find_stop_post(self) -> str:
        """Where the service takes emergency stops whatever else it does; '' if it does not say so.

        Who may have to stop a bench asks beforehand: a service that is flooded answers late.
        """
        self._stop_url = self.health().stop_url
        return self._stop_url

    def benches(self) -> list[BenchData]:
        """All benches and what they do."""
        return self._several(BenchData, "/benches")

    def bench(self, bench: str) -> BenchData:
        """A bench and what it does."""
        return self._one(BenchData, "GET", f"/benches/{part(bench)}")

    def stop_in_emergency(self, bench: str) -> None:
        """Have a bench safe at once, and keep it so until it is reset.

        The stop post and the API are asked at the same moment; the first that has taken it is enough.
        """
        path = f"/benches/{part(bench)}/emergency-stop"
        first_of([lambda: self._post_to_stop_post(path), lambda: self._done("POST", path)], WITHIN_S)

    def _post_to_stop_post(self, path: str) -> None:
        url = self._stop_url or self.find_stop_post()
        if not url:
            raise BenchError("the service has no stop post", where=self._url)
        with Requests(url, self._token)._opened("POST", path, None, WITHIN_S):
            pass

    def reset(self, bench: str) -> BenchData:
        """Let a bench be armed again after an emergency stop."""
        return self._one(BenchData, "POST", f"/benches/{part(bench)}/reset")

    def lease(self, bench: str, for_s: float = 60.0) -> LeaseData:
        """Have a bench for oneself for a while; call it again before it is over to go on."""
        return self._one(LeaseData, "PUT", f"/benches/{part(bench)}/lease", LeaseWanted(for_s=for_s))

    def queue_of(self, bench: str) -> list[RunData]:
        """Runs that wait for a bench in their order, with when they are expected to start and to end."""
        return self._several(RunData, f"/benches/{part(bench)}/queue")

    def reservations(self, bench: str) -> list[ReservationData]:
        """Present and future reservations of a bench, the next first."""
        return self._several(ReservationData, f"/benches/{part(bench)}/reservations")

    def reserve(
        self, bench: str, begins: datetime.datetime, ends: datetime.datetime, reason: str
    ) -> ReservationData:
        """Reserve a bench between two moments with zones: queued runs of others do not start meanwhile."""
        wanted = ReservationWanted(begins=begins, ends=ends, reason=reason)
        return self._one(ReservationData, "POST", f"/benches/{part(bench)}/reservations", wanted)

    def remove_reservation(self, bench: str, reservation: int) -> None:
        """Remove a reservation of one's own."""
        self._done("DELETE", f"/benches/{part(bench)}/reservations/{reservation}")

    def admit(self, bench: str, reservation: int, run: int) -> None:
        """Let a queued run of somebody else start within one's reservation."""
        self._done("PUT", f"/benches/{part(bench)}/reservations/{reservation}/runs/{run}")

    def handovers(self, bench: str, most: int = 20) -> list[HandoverData]:
        """Hand-over notes of a bench, newest first."""
        return self._several(HandoverData, f"/benches/{part(bench)}/handovers?most={most}")

    def add_handover(self, bench: str, wanted: HandoverWanted) -> HandoverData:
        """Add a note for the next shift."""
        return self._one(HandoverData, "POST", f"/benches/{part(bench)}/handovers", wanted)

    def give_back(self, bench: str) -> BenchData:
        """Give a bench back."""
        return self._one(BenchData, "DELETE", f"/benches/{part(bench)}/lease")
