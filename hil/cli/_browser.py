"""Shows a report in the browser of whoever sits here."""

from __future__ import annotations

import logging
import subprocess
import sys
from pathlib import Path

logger = logging.getLogger(__name__)


def show_in_browser(page: Path) -> None:
    """Ask for a browser and do not wait for it; nothing is said where there is none.

    In a process of its own: some browsers write to the terminal, and some last as long as their window.
    """
    nothing = subprocess.DEVNULL
    try:
        subprocess.Popen(
            [sys.executable, "-m", "webbrowser", page.resolve().as_uri()],
            stdin=nothing,
            stdout=nothing,
            stderr=nothing,
            start_new_session=True,
        )
    except OSError as error:
        logger.info("no browser: %s", error)
