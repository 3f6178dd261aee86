"""`python -m hil.service`: prints the OpenAPI document (make openapi)."""

from hil.service.api import openapi_text

print(openapi_text(), end="")
