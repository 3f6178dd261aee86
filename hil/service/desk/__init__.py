"""What takes longer than a turn of the loop and is asked for again and again: a process kept warm."""

from hil.service.desk._desk import Desk, TooLongError

__all__ = ["Desk", "TooLongError"]
