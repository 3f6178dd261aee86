"""The secret of this service's client at the provider."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

SECRET_ENV = "HIL_TEST_SIGN_IN_SECRET"


@pytest.fixture(scope="session", autouse=True)
def _secret() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(SECRET_ENV, "a secret of the client")
        yield
