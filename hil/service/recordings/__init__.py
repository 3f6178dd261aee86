"""Recordings that people give: taken in pieces, read in another process, then there for studies."""

from hil.service.recordings._given_recordings import GivenRecordings
from hil.service.recordings._room import Room

__all__ = ["GivenRecordings", "Room"]
