"""What a recording says about the files that it holds."""

from __future__ import annotations

import hashlib


def hashes(attachments: dict[str, bytes]) -> dict[str, str]:
    """SHA-256 of each attachment."""
    return {name: hashlib.sha256(content).hexdigest() for name, content in sorted(attachments.items())}
