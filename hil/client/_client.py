"""What can be asked of a bench service, with the types that the service itself uses."""

from __future__ import annotations

from hil.client._agent_requests import AgentRequests
from hil.client._bench_requests import BenchRequests
from hil.client._design_requests import DesignRequests
from hil.client._people_requests import PeopleRequests
from hil.client._recording_requests import RecordingRequests
from hil.client._run_requests import RunRequests
from hil.client._study_requests import StudyRequests
from hil.client._tuning_requests import TuningRequests


class Client(
    BenchRequests,
    RunRequests,
    DesignRequests,
    RecordingRequests,
    StudyRequests,
    TuningRequests,
    AgentRequests,
    PeopleRequests,
):
    """A bench service.

    Every method raises RefusedError if the service refuses, and BenchError if it cannot be reached or does
    not answer as one.

    Args:
        url: where it is, as `hil serve` says: `http://127.0.0.1:8080`.
        token: who asks; a service without tokens asks no one.
    """
