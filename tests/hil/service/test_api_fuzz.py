"""Calls that no one thought of, made from the OpenAPI document: no 5xx, no hang, nothing but what it says."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, settings
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import response_schema_conformance, status_code_conformance

from hil.service.api import openapi_text
from tests.hil.service.served import Served, served

#: `make api-fuzz` makes thousands.
CALLS = int(os.environ.get("HIL_API_CALLS", "3"))
#: It ends when its viewer goes.
_ENDLESS = "/api/v1/benches/{bench}/live"

schema = schemathesis.openapi.from_dict(json.loads(openapi_text())).exclude(path=_ENDLESS)
pytestmark = pytest.mark.slow


@schemathesis.serializer("application/toml")
def as_toml(context: Any, value: object) -> bytes:
    """Models and controllers are given as the text that they are."""
    return value if isinstance(value, bytes) else str(value).encode("utf-8", "replace")


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("fuzz")
    with served(folder / "data", "--rate", "100000", state=folder / "state") as service:
        yield service


@schema.parametrize()
@settings(
    max_examples=CALLS,
    deadline=None,
    derandomize=True,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=list(HealthCheck),
)
def test_any_call_is_answered_as_the_document_says(case: Any, there: Served) -> None:
    answer = case.call(base_url=there.url, timeout=30)
    checks = [not_a_server_error, status_code_conformance, response_schema_conformance]
    case.validate_response(answer, checks=checks)
