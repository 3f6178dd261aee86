"""The application: REST below /api/v1, what is live as server-sent events, and the page."""

from hil.service.api._application import application, openapi_text

__all__ = ["application", "openapi_text"]
