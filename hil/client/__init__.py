"""A typed client of the bench service (docs/reference/api.md); needs nothing that only the service does."""

from hil.api_schemas.api import RunData, RunWanted
from hil.api_schemas.campaign import CampaignWanted
from hil.api_schemas.recording import RecordingData
from hil.api_schemas.study import DiagnosisWanted, IdentificationWanted
from hil.api_schemas.tuning import AutotuningPlanned, AutotuningWanted, TuningWanted
from hil.client._client import Client
from hil.client._requests import RefusedError

__all__ = [
    "AutotuningPlanned",
    "AutotuningWanted",
    "CampaignWanted",
    "Client",
    "DiagnosisWanted",
    "IdentificationWanted",
    "RecordingData",
    "RefusedError",
    "RunData",
    "RunWanted",
    "TuningWanted",
]
