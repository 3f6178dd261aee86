"""The application: REST below /api/v1, what is live as server-sent events, and the page."""

from hil.service.api._application import application, openapi_text
from hil.service.api._connections import bounded
from hil.service.api._guard import Guarding, Rates, StopAddress

__all__ = ["Guarding", "Rates", "StopAddress", "application", "bounded", "openapi_text"]
