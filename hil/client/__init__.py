"""A typed client of the bench service (docs/reference/api.md); needs nothing that only the service does."""

from hil.client._client import Client
from hil.client._requests import RefusedError
from hil.messages.api import RunData, RunWanted
from hil.messages.campaign import CampaignWanted

__all__ = ["CampaignWanted", "Client", "RefusedError", "RunData", "RunWanted"]
