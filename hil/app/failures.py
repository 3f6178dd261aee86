"""What ended a use case, as one error with what, where and what to do."""

from __future__ import annotations

import logging
import resource
import traceback
from pathlib import Path

from hil.core.errors import BenchError, HilError
from hil.core.errors.extras import not_installed
from hil.core.files import of_the_system

logger = logging.getLogger(__name__)


def error_of(error: Exception) -> HilError:
    """The error to be shown for any exception; a mistake of the program is logged with its traceback."""
    if isinstance(error, HilError):
        logger.debug("ended by", exc_info=error)
        return error
    if isinstance(error, OSError):
        return of_the_system(error)
    if isinstance(error, ModuleNotFoundError):
        return not_installed(error) or _internal(error)
    if isinstance(error, MemoryError):
        return _too_little_memory()
    return _internal(error)


def _too_little_memory() -> BenchError:
    limit, _ = resource.getrlimit(resource.RLIMIT_DATA)  # a service sets one for what it begins
    limited = f", which may use {limit / 1e9:.3g} GB" if limit != resource.RLIM_INFINITY else ""
    return BenchError(
        f"there is not enough memory for this command{limited}", fix="use a shorter recording or plan"
    )


def _internal(error: Exception) -> BenchError:
    """Where the mistake was; its traceback is in the log, for whoever mends it."""
    logger.error("internal error", exc_info=error)
    at = traceback.extract_tb(error.__traceback__)[-1]
    return BenchError(
        f"internal error: {type(error).__name__}: {error}",
        where=f"{Path(at.filename).name}:{at.lineno}",
        fix="please report it with the log, the command and its input",
    )
