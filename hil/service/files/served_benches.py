"""Simulated benches that people gave and put into service: each in a folder with the files that it names.

What moves is computed, so that whoever may write a bench file may have it served. A bench on hardware is
served by whoever has its machine (`hil serve --bench`).
"""

from __future__ import annotations

import logging
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hil.core.errors import BadInputError, HilError
from hil.core.files import make_directory, read_text, write_atomically
from hil.core.files.toml_file import parse_toml
from hil.engine.bench.bench_file import shipped
from hil.engine.bench.named_files import named_files
from hil.execution.benches import Bench

logger = logging.getLogger(__name__)


class ServedBenches:
    """Those of a service; a folder of its own says that a bench is served.

    Args:
        folder: where each has a folder.
        stops: where the service keeps the stops of its simulated benches.
    """

    def __init__(self, folder: Path, stops: Path) -> None:
        self._folder, self._stops = folder, stops
        make_directory(folder)

    def there(self, refused: Callable[[str], str]) -> dict[str, Bench]:
        """Those that were served before; one that cannot be is left out, and reported in the log.

        Args:
            refused: why one of a name is not this service's; '' if it is.
        """
        found = {}
        for path in sorted(self._folder.glob("[!.]*/bench.toml")):
            try:
                bench, why = Bench(str(path), self._stops), refused(path.parent.name)
            except HilError as error:
                why = str(error)
            if why:
                logger.warning("the bench '%s' is not served: %s", path.parent.name, why)
            else:
                found[bench.name] = bench
        return found

    def add(self, name: str, text: str, models: Mapping[str, Path]) -> Bench:
        """Lay a bench file with what it names into a folder.

        Raises:
            BadInputError: it is not simulated, has another name, or cannot be used.
        """
        data = parse_toml(text, f"{name}.toml")
        if "simulation" not in data:
            raise BadInputError(
                "is a bench on hardware",
                where=name,
                fix="serve it where its buses are: hil serve --bench FILE",
            )
        if data.get("name") != name:
            what = f"the name in the bench file is '{data.get('name')}'"
            raise BadInputError(what, where=name, fix="give the file under that name")
        place = self._folder / name
        arriving = self._folder / f".{name}"
        shutil.rmtree(arriving, ignore_errors=True)
        make_directory(arriving)
        try:
            _lay(arriving, data, text, models)
            shutil.rmtree(place, ignore_errors=True)
            arriving.replace(place)
            return Bench(str(place / "bench.toml"), self._stops)
        except BaseException:
            shutil.rmtree(place, ignore_errors=True)
            raise
        finally:
            shutil.rmtree(arriving, ignore_errors=True)

    def remove(self, name: str) -> None:
        """Serve one no longer."""
        (self._folder / name / "bench.toml").unlink(missing_ok=True)  # first: what is left then is no bench
        shutil.rmtree(self._folder / name, ignore_errors=True)

    def has(self, name: str) -> bool:
        """Whether one is served."""
        return (self._folder / name / "bench.toml").is_file()


def _lay(folder: Path, data: dict[str, Any], text: str, models: Mapping[str, Path]) -> None:
    for key, value in named_files(data):
        if value != Path(value).name or value == "bench.toml":
            raise BadInputError(
                f"{key} = '{value}' is not the name of a file of the service", where=folder.name
            )
        model = models.get(value.removesuffix(".toml"))
        source = model if key == "simulation.model" and model is not None else shipped(value)
        write_atomically(folder / value, read_text(source))
    write_atomically(folder / "bench.toml", text)
