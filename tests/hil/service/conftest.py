"""One service for all tests that leave it as they found it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.hil.service.served import ASKING, SHORT, Served, served


@pytest.fixture(scope="package")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("service")
    with served(folder / "data", state=folder / "state") as one:
        one.give("short", SHORT)
        one.give("asking", ASKING)
        yield one
