"""A service that ends while it answers: a refusal in its words, and no error in its log."""

from __future__ import annotations

import asyncio
import json

from starlette.types import Message, Receive, Scope, Send

from hil.service.api._guard import Guard, Guarding, Rates

_SCOPE: Scope = {
    "type": "http",
    "method": "POST",
    "path": "/api/v1/forecasts",
    "headers": [(b"host", b"localhost")],
    "client": ("127.0.0.1", 1),
}


def _ended_while(answering: list[Message]) -> list[Message]:
    """What is sent by an application that has sent so much when the server gives it up."""
    sent: list[Message] = []

    async def application(scope: Scope, receive: Receive, send: Send) -> None:
        for message in answering:
            await send(message)
        await asyncio.Event().wait()

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        sent.append(message)

    async def end_it() -> None:
        guard = Guard(application, Guarding(("localhost",), Rates(10, 10)))
        task = asyncio.create_task(guard(_SCOPE, receive, send))
        await asyncio.sleep(0.01)
        task.cancel("Task cancelled, timeout graceful shutdown exceeded")  # as uvicorn does
        await task

    asyncio.run(end_it())
    return sent


def test_who_waits_for_an_answer_is_told_that_the_service_ends() -> None:
    head, body = _ended_while([])
    assert head["status"] == 503
    assert json.loads(body["body"]) == {
        "what": "the service ends",
        "where": "",
        "fix": "ask again when it is up",
    }


def test_an_answer_that_has_begun_is_left_as_it_is() -> None:
    sent = _ended_while([{"type": "http.response.start", "status": 200, "headers": []}])
    assert [message["type"] for message in sent] == ["http.response.start"]
