"""The application: REST below /api/v1, what is live as server-sent events, and the page."""

from hil.service.api._application import application, openapi_text
from hil.service.api._guard import Rates

__all__ = ["Rates", "application", "openapi_text"]
