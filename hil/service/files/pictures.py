"""Pictures that plans show with their prompts: rows of the database, and files beside the given plans."""

from __future__ import annotations

import base64
import re
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.errors.wording import shortened
from hil.core.files import is_file, write_atomically
from hil.service.files.uploads import NameTakenError
from hil.service.store import GivenStore, asked_apart
from test_plans import MOST_PICTURE_BYTES, PICTURE

MEDIA = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg", ".svg": "image/svg+xml"}
_BEGINNINGS = {".png": b"\x89PNG\r\n\x1a\n", ".jpg": b"\xff\xd8\xff", ".jpeg": b"\xff\xd8\xff"}
_SVG = re.compile(rb"^(\xef\xbb\xbf)?\s*(<\?xml[^>]*>\s*)?(<!--.*?-->\s*)*<svg[\s>]", re.DOTALL)


@asked_apart
class Pictures:
    """Pictures by name. A name stands for one content: who wants to change it gives a new name.

    Args:
        folder: of the given plans.
    """

    def __init__(self, store: GivenStore, folder: Path) -> None:
        self._store, self._folder = store, folder
        self._brought: dict[str, str] = {}

    def names(self) -> list[str]:
        """Of all that there are."""
        return list(self._store.all("picture"))

    def content(self, name: str) -> bytes | None:
        """One as it was given; None if there is none."""
        found = self._store.get("picture", name)
        return None if found is None or found.removed else base64.b64decode(found.text)

    def give(self, name: str, content: bytes, by: str) -> None:
        """Keep one; the same may be given again.

        Raises:
            NameTakenError: the name stands for another picture.
            BadInputError: it is no picture of the kind that its name says, or too large.
        """
        refuse_no_picture(name, content)
        if not self._store.give("picture", name, base64.b64encode(content).decode("ascii"), by):
            raise NameTakenError("is the name of another picture", where=name, fix="give it another name")

    def remove(self, name: str) -> bool:
        """Remove one; false if there is none."""
        return self._store.remove("picture", name)

    def bring(self) -> None:
        """Have all of them lie in the folder, and no others."""
        wanted = self._store.all("picture")
        for path in self._folder.iterdir() if self._folder.is_dir() else ():
            if path.suffix in MEDIA and path.name not in wanted:
                path.unlink(missing_ok=True)
        for name, sha256 in wanted.items():
            if self._brought.get(name) != sha256 or not is_file(self._folder / name):
                content = self.content(name)
                if content is not None:
                    write_atomically(self._folder / name, content)
                    self._brought[name] = sha256


def refuse_no_picture(name: str, content: bytes) -> None:
    """Refuse what a browser would not show as the kind of picture that the name says.

    Raises:
        BadInputError: it is no such picture, or too large.
    """
    ending = Path(name).suffix
    if re.fullmatch(PICTURE, name) is None:
        raise BadInputError(
            "is no name of a picture",
            where=shortened(name, 100),
            fix="letters, digits, _ and -, then .png, .jpg or .svg",
        )
    if len(content) > MOST_PICTURE_BYTES:
        raise BadInputError(
            f"has more than {MOST_PICTURE_BYTES // 1000} kB", where=name, fix="make it smaller"
        )
    fits = _SVG.match(content) is not None if ending == ".svg" else content.startswith(_BEGINNINGS[ending])
    if not fits:
        raise BadInputError(
            f"is no {MEDIA[ending].removeprefix('image/').removesuffix('+xml').upper()}",
            where=name,
            fix="give a picture of the kind that its name says",
        )
