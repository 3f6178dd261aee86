"""Debian's Firefox, driven by Marionette, the protocol that it speaks itself.

Playwright's own Firefox is a build of its own that no package brings, its way to an unchanged one sends a
command that the long-term release does not know, and Debian has no geckodriver. Marionette is what that would
speak: https://firefox-source-docs.mozilla.org/testing/marionette/Protocol.html.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FIREFOX = shutil.which("firefox-esr") or shutil.which("firefox")
KEYS = {"Tab": "\ue004", "Enter": "\ue007", "Control": "\ue009"}
"""As WebDriver writes them: https://www.w3.org/TR/webdriver2/#keyboard-actions."""
_WITHIN_S = 90.0
_PREFERENCES: dict[str, str | int | bool] = {
    "app.normandy.enabled": False,
    "app.update.disabledForTesting": True,
    "browser.shell.checkDefaultBrowser": False,
    "browser.startup.page": 0,
    "datareporting.policy.dataSubmissionEnabled": False,
    "media.autoplay.default": 0,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "services.settings.server": "data:,#remote-settings-dummy/v1",
    "toolkit.telemetry.reportingpolicy.firstRun": False,
}


class FirefoxError(Exception):
    """What Firefox answered in place of a result."""


class Firefox:
    """A window of it."""

    def __init__(self, port: int) -> None:
        self._socket = self._connected(port)
        self._number = 0
        self._read()  # who it is
        self.ask("WebDriver:NewSession", {"capabilities": {"alwaysMatch": {"acceptInsecureCerts": False}}})

    @staticmethod
    def _connected(port: int) -> socket.socket:
        until_s = time.monotonic() + _WITHIN_S
        while True:
            try:
                return socket.create_connection(("127.0.0.1", port), timeout=_WITHIN_S)
            except OSError:
                if time.monotonic() > until_s:
                    raise
                time.sleep(0.1)

    def ask(self, command: str, parameters: dict[str, Any]) -> Any:
        """Have a command of WebDriver carried out.

        Raises:
            FirefoxError: it was refused, or failed.
        """
        self._number += 1
        text = json.dumps([0, self._number, command, parameters]).encode()
        self._socket.sendall(f"{len(text)}:".encode() + text)
        _, _, error, result = self._read()
        if error is not None:
            raise FirefoxError(f"{command}: {error['message']}")
        return result

    def open(self, url: str) -> None:
        """Show an address; returns when its document is loaded."""
        self.ask("WebDriver:Navigate", {"url": url})

    def run(self, script: str, *arguments: object) -> Any:
        """What a function's body returns in the page; a promise is awaited."""
        done = "arguments[arguments.length - 1]"
        awaited = (
            f"const done = {done}; const body = async function () {{ {script}\n }};\n"
            "body(...[...arguments].slice(0, -1)).then(done, (why) => done({ failed: String(why) }));"
        )
        answer = self.ask(
            "WebDriver:ExecuteAsyncScript",
            {"script": awaited, "args": list(arguments), "sandbox": None, "newSandbox": False},
        )
        value = answer["value"]
        if isinstance(value, dict) and "failed" in value:
            raise FirefoxError(value["failed"])
        return value

    def until(self, script: str, *arguments: object) -> Any:
        """What a function's body returns once that is true of anything."""
        until_s = time.monotonic() + _WITHIN_S
        while not (found := self.run(script, *arguments)):
            if time.monotonic() > until_s:
                raise FirefoxError(f"never true: {script}")
            time.sleep(0.1)
        return found

    def press(self, *keys: str, held: str = "") -> None:
        """Press keys one after the other as a person would: letters, or names of `KEYS`.

        Args:
            held: name of a key that is held meanwhile.
        """
        values = [KEYS.get(key, key) for key in keys]
        around = [KEYS[held]] if held else []
        steps = [{"type": "keyDown", "value": one} for one in around]
        steps += [{"type": kind, "value": one} for one in values for kind in ("keyDown", "keyUp")]
        steps += [{"type": "keyUp", "value": one} for one in around]
        keyboard = {"type": "key", "id": "keyboard", "actions": steps}
        self.ask("WebDriver:PerformActions", {"actions": [keyboard]})

    def resize(self, width: int, height: int) -> None:
        """Give the window a size in pixels."""
        self.ask("WebDriver:SetWindowRect", {"width": width, "height": height})

    def quit(self) -> None:
        """End it."""
        with contextlib.suppress(FirefoxError, OSError):
            self.ask("Marionette:Quit", {"flags": ["eForceQuit"]})
        self._socket.close()

    def _read(self) -> Any:
        length = b""
        while not length.endswith(b":"):
            length += self._received(1)
        return json.loads(self._received(int(length[:-1])))

    def _received(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            piece = self._socket.recv(count - len(data))
            if not piece:
                raise FirefoxError("it has ended")
            data += piece
        return data


@contextlib.contextmanager
def firefox(folder: Path, *, language: str = "en", dark: bool = False) -> Iterator[Firefox]:
    """Start it with a profile of its own in `folder`, and end it."""
    assert FIREFOX is not None
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    chosen = {"marionette.port": port, "intl.accept_languages": language, "ui.systemUsesDarkTheme": int(dark)}
    lines = [
        f"user_pref({json.dumps(name)}, {json.dumps(one)});" for name, one in (_PREFERENCES | chosen).items()
    ]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "user.js").write_text("\n".join(lines))
    command = [FIREFOX, "--headless", "--no-remote", "--marionette", "--profile", str(folder)]
    environment = {**os.environ, "MOZ_CRASHREPORTER_DISABLE": "1", "HOME": str(folder)}
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(command, stdout=quiet, stderr=quiet, env=environment)
    try:
        window = Firefox(port)
        try:
            yield window
        finally:
            window.quit()
    finally:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(10)
        if process.poll() is None:
            process.kill()
            process.wait()
