"""Notices that were not taken are sent again, also by the next service."""

from __future__ import annotations

import json
import time
from pathlib import Path

import pytest

from hil.service.notices import NoticeSettings, Post
from hil.service.notices._notice import of_stop
from hil.service.notices._post import Seen
from hil.service.notices._settings import Webhook
from tests.hil.service.notices.receivers import Posts, listening

_NOTICE = of_stop("rig", "pressed", "")


def _settings(url: str) -> NoticeSettings:
    return NoticeSettings(webhook=(Webhook(url=url),))


def test_a_notice_survives_a_recipient_and_a_service_that_were_down(tmp_path: Path) -> None:
    with listening(Posts()) as server:
        server.status = 503
        post = Post(tmp_path, _settings(server.url))
        post.seen = Seen(7, frozenset({3}), frozenset({3}))
        post.add(_NOTICE)
        assert post.send_due()
        assert not post.send_due()  # later
        post.keep()
        server.status = 204
        again = Post(tmp_path, _settings(server.url))
        assert again.seen == post.seen
        assert again.send_due()
        assert not again.send_due()
    ids = [headers["webhook-id"] for headers, _ in server.got]
    assert ids == [_NOTICE.id, _NOTICE.id]


def test_it_is_given_up_after_a_day(tmp_path: Path) -> None:
    post = Post(tmp_path, _settings("http://127.0.0.1:9/"))
    post.add(_NOTICE)
    post.keep()
    kept = json.loads((tmp_path / "notices.json").read_text())
    kept["waiting"][0]["since_s"] = time.time() - 100_000.0
    (tmp_path / "notices.json").write_text(json.dumps(kept))
    later = Post(tmp_path, _settings("http://127.0.0.1:9/"))
    later.send_due()
    assert [name for name, _ in later.given_up] == ["http://127.0.0.1:9"]
    assert not later.send_due()


@pytest.mark.parametrize(
    "text", ["", "{}", "[]", '{"seen": {}, "waiting": []}', '{"seen": null, "waiting": [1]}']
)
def test_a_file_that_is_spoilt_ends_nothing(tmp_path: Path, text: str) -> None:
    (tmp_path / "notices.json").write_text(text)
    post = Post(tmp_path, _settings("http://127.0.0.1:9/"))
    post.add(_NOTICE)
    post.keep()


def test_what_waits_for_somebody_who_is_no_recipient_any_more_is_dropped(tmp_path: Path) -> None:
    post = Post(tmp_path, _settings("http://127.0.0.1:9/"))
    post.add(_NOTICE)
    post.keep()
    assert not Post(tmp_path, _settings("http://127.0.0.2:9/")).send_due()
