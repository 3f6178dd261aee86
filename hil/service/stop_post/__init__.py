"""The stop post: emergency stops by a way of their own, which nothing else of the service can hold up."""

from hil.service.stop_post._answering import COOKIE
from hil.service.stop_post._messages import OwnBench, Owner, Stopped
from hil.service.stop_post._post import StopLine, StopPost

__all__ = ["COOKIE", "OwnBench", "Owner", "StopLine", "StopPost", "Stopped"]
