"""What takes longer than a turn of the loop and is asked for again and again: a process kept warm."""

from hil.service.desk._desk import READ_WITHIN_S, READING, Desk, TooLongError

__all__ = ["READING", "READ_WITHIN_S", "Desk", "TooLongError"]
