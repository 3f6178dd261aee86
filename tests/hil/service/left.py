"""What a run has left that somebody was killed in: nothing unsafe, nothing half."""

from __future__ import annotations

import json
from pathlib import Path

from hil.core.recording import read_recording


def was_safe_and_whole(folder: Path, state: str) -> None:
    """Asserts that the bench was safe, and that its process has closed the recording."""
    recording, result = folder / "recording.mcap", folder / "result.json"
    if state == "ended":
        assert json.loads(result.read_text())["safe_state"] == "confirmed"
    if result.exists():
        assert json.loads(result.read_text())["safe_state"] in ("confirmed", "not_needed")
    if recording.exists():
        found = read_recording(recording, least_samples=0, allow_missing=True)
        assert found.damage == [], "its process has closed it"
