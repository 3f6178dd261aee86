"""The file that says who gets which notices."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from hil.service.notices import read_settings

_GOOD = """
address = "https://bench.example.org"

[[webhook]]
url = "https://chat.example.org/hook/1"
events = ["run_ended"]
benches = ["sim"]

[[mail]]
host = "mail.example.org"
sender = "bench@example.org"
to = ["lab@example.org"]
"""


def _read(tmp_path: Path, text: str) -> object:
    path = tmp_path / "notices.toml"
    path.write_text(text)
    return read_settings(path)


def test_a_recipient_gets_what_it_asks_for(tmp_path: Path) -> None:
    path = tmp_path / "notices.toml"
    path.write_text(_GOOD)
    webhook, mail = read_settings(path).recipients
    assert webhook.wants("run_ended", "sim")
    assert not webhook.wants("run_ended", "other")
    assert not webhook.wants("run_failed", "sim")
    assert webhook.wants("test", "")
    assert mail.wants("run_failed", "other")
    assert not mail.wants("run_ended", "sim")
    assert webhook.name == "https://chat.example.org"  # a path may be a secret


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("https://chat.example.org/hook/1", "chat.example.org"), "line 4: webhook[1]: url must begin with"),
        (("run_ended", "run_done"), "line 6: webhook[1].events[1] = 'run_done': must be"),
        (("sender =", "from ="), "mail[1].sender: is missing"),
        (("lab@example.org", "lab"), "line 12: mail[1].to[1] = 'lab'"),
        (('host = "mail', 'user = "u"\nhost = "mail'), "user and password_env go together"),
        (
            ('host = "mail', 'user = "u"\npassword_env = "HOME"\nsecurity = "none"\nhost = "mail'),
            "not sent without encryption",
        ),
        (("benches =", 'secret_env = "NO_SUCH_SECRET"\nbenches ='), "the environment has no NO_SUCH_SECRET"),
        ((_GOOD, "address = ''"), "has no recipient"),
    ],
)
def test_a_mistake_is_named_with_its_place(tmp_path: Path, change: tuple[str, str], words: str) -> None:
    with pytest.raises(BadInputError) as refused:
        _read(tmp_path, _GOOD.replace(*change))
    assert words in str(refused.value)
    assert "docs/how-to/notices.md" in str(refused.value)


def test_all_mistakes_are_named_each_at_its_line(tmp_path: Path) -> None:
    text = _GOOD.replace("run_ended", "run_done").replace("host =", "hosts =").replace("lab@", "lab.")
    second = '\n[[webhook]]\nurl = "ftp://hidden/secret"\nsecret_env = "NO_SUCH_SECRET"\n'
    with pytest.raises(BadInputError) as refused:
        _read(tmp_path, text + second)
    words = str(refused.value)
    for one in (
        "4 mistakes",
        "line 6: webhook[1].events[1] = 'run_done': must be",
        "line 10: mail[1].hosts: unknown key; did you mean 'host'?",
        "line 12: mail[1].to[1] = 'lab.example.org': must be one address, as name@example.org",
        "line 14: webhook[2]: url must begin with https:// or http:// and name a host; the environment has",
    ):
        assert one in words
    assert "secret'" not in words


def test_a_file_that_is_not_there_is_asked_for_by_what_it_holds(tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as refused:
        read_settings(tmp_path / "none.toml")
    assert refused.value.fix.startswith("give the file of who gets notices")


@given(st.text(max_size=200))
def test_any_text_is_settings_or_bad_input(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.mktemp("any") / "notices.toml"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    with pytest.raises(BadInputError):
        read_settings(path)
