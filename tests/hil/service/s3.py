"""A server of S3 on this machine: s3proxy, from Maven, with files in a folder."""

from __future__ import annotations

import contextlib
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest

_PLACE = Path(tempfile.gettempdir()) / "eaxle-hil-s3proxy"
_VERSION = "2.6.0"
_POM = f"""<project xmlns="http://maven.apache.org/POM/4.0.0"><modelVersion>4.0.0</modelVersion>
<groupId>r</groupId><artifactId>r</artifactId><version>1</version><dependencies><dependency>
<groupId>org.gaul</groupId><artifactId>s3proxy</artifactId><version>{_VERSION}</version>
</dependency></dependencies></project>"""
_COPY = "org.apache.maven.plugins:maven-dependency-plugin:3.6.1:copy-dependencies"
_KEY, _SECRET = "for-tests", "nothing-to-hide"
BUCKET = "recordings"


class S3:
    """A server that is started and ended; what it was given stays."""

    def __init__(self, jars: Path, folder: Path) -> None:
        self._jars, self.folder = jars, folder
        with socket.create_server(("127.0.0.1", 0)) as free:
            self._port = free.getsockname()[1]
        (folder / "kept" / BUCKET).mkdir(parents=True)
        settings = {
            "s3proxy.endpoint": self.url,
            "s3proxy.authorization": "aws-v2-or-v4",
            "s3proxy.identity": _KEY,
            "s3proxy.credential": _SECRET,
            "jclouds.provider": "filesystem",
            "jclouds.filesystem.basedir": str(folder / "kept"),
        }
        text = "".join(f"{name}={value}\n" for name, value in settings.items())
        (folder / "s3proxy.conf").write_text(text)
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self._port}"

    @property
    def environment(self) -> dict[str, str]:
        """What a program finds it by."""
        return {
            "AWS_ENDPOINT_URL": self.url,
            "AWS_ACCESS_KEY_ID": _KEY,
            "AWS_SECRET_ACCESS_KEY": _SECRET,
            "AWS_DEFAULT_REGION": "us-east-1",
        }

    def begin(self) -> None:
        """Start it; it answers when this returns."""
        command = ["java", "-Xmx128m", "-XX:TieredStopAtLevel=1", "-cp", f"{self._jars}/*"]
        command += ["org.gaul.s3proxy.Main", "--properties", str(self.folder / "s3proxy.conf")]
        with (self.folder / "log").open("ab") as log:
            self._process = subprocess.Popen(command, stdout=log, stderr=log, cwd=self.folder)
        until_s = time.monotonic() + 60.0
        while not self._answers():
            assert time.monotonic() < until_s
            assert self._process.poll() is None, (self.folder / "log").read_text()[-2000:]
            time.sleep(0.1)

    def end(self) -> None:
        """Kill it in the middle of whatever it does."""
        if self._process is not None:
            self._process.kill()
            self._process.wait(30)
        self._process = None

    def names(self) -> list[str]:
        """What it has."""
        root = self.folder / "kept" / BUCKET
        return sorted(str(path.relative_to(root)) for path in root.rglob("*") if path.is_file())

    def _answers(self) -> bool:
        try:
            with urllib.request.urlopen(self.url, timeout=2):
                return True
        except urllib.error.HTTPError as error:
            error.close()
            return True
        except OSError:
            return False


def _jars() -> Path:
    if not list(_PLACE.glob("s3proxy-*.jar")):
        if not (shutil.which("mvn") and shutil.which("java")):
            pytest.skip(
                "s3proxy needs java and mvn; as root on Debian: apt-get install default-jre-headless maven"
            )
        _PLACE.mkdir(parents=True, exist_ok=True)
        (_PLACE / "pom.xml").write_text(_POM)
        command = ["mvn", "-q", "-B", _COPY, f"-DoutputDirectory={_PLACE}"]
        done = subprocess.run(command, cwd=_PLACE, capture_output=True, text=True, timeout=600)
        if done.returncode:
            pytest.skip(f"s3proxy cannot be had from Maven: {done.stdout.strip()[-200:]}")
    return _PLACE


@contextlib.contextmanager
def s3_server(folder: Path) -> Iterator[S3]:
    """A server that runs; the test is skipped where none can be had."""
    pytest.importorskip("s3fs")
    server = S3(_jars(), folder)
    server.begin()
    try:
        yield server
    finally:
        server.end()
