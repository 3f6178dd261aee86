"""What takes longer than a turn of the loop and is asked for again and again: a process kept warm."""

from hil.service.worker_pool._worker_pool import READ_WITHIN_S, READING, TooLongError, WorkerPool

__all__ = ["READING", "READ_WITHIN_S", "TooLongError", "WorkerPool"]
