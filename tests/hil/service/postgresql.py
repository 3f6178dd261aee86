"""A PostgreSQL server of our own in a temporary folder: Debian's, started and ended by the tests."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

_PLACES = Path("/usr/lib/postgresql")  # where Debian has its programs, by version
_ACCOUNT = "postgres"  # the server refuses to run as root
#: Neither the server's zone nor its order of letters may matter.
_SETTINGS = "-c timezone=Asia/Kolkata -c fsync=off -c max_connections=40"


class Cluster:
    """A server that listens to a socket in its folder, and to this machine at a port if it is given one.

    At its port it speaks TLS with the certificate `certificate`, which is for the name localhost.
    """

    def __init__(self, folder: Path, programs: Path, port: int = 0) -> None:
        self._folder, self._programs, self._port = folder, programs, port
        self._run("initdb", "-D", folder / "data", "-A", "trust", "-U", "hil", "-E", "UTF8", "--no-sync")

    def begin(self) -> None:
        """Start it; it answers when this returns."""
        options = f"{_SETTINGS} -k {self._folder}"
        if self._port:
            files = f"-c ssl_cert_file={self.certificate} -c ssl_key_file={self._make_certificate()}"
            options += f" -c listen_addresses=127.0.0.1 -p {self._port} -c ssl=on {files}"
        else:
            options += " -c listen_addresses=''"
        self._run(
            "pg_ctl", "-D", self._folder / "data", "-w", "-l", self._folder / "log", "-o", options, "start"
        )

    def end(self) -> None:
        """Stop it in the middle of whatever it does."""
        self._run("pg_ctl", "-D", self._folder / "data", "-w", "-m", "immediate", "stop")

    @property
    def certificate(self) -> Path:
        return self._folder / "certificate.pem"

    def _make_certificate(self) -> Path:
        key = self._folder / "key.pem"
        subject = ["-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"]
        command = [
            "req",
            "-x509",
            "-newkey",
            "ec",
            "-pkeyopt",
            "ec_paramgen_curve:prime256v1",
            "-nodes",
            *subject,
        ]
        self._run_at("openssl", *command, "-days", "2", "-keyout", key, "-out", self.certificate)
        return key

    @contextlib.contextmanager
    def frozen(self) -> Iterator[None]:
        """It takes connections and says nothing, as one behind a broken network."""
        first = int((self._folder / "data/postmaster.pid").read_text().splitlines()[0])
        told = Path(f"/proc/{first}/task/{first}/children").read_text()
        processes = [first, *map(int, told.split())]
        for process in processes:
            os.kill(process, signal.SIGSTOP)
        try:
            yield
        finally:
            for process in processes:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, signal.SIGCONT)

    def database(self) -> str:
        """The URL of a new, empty database."""
        name = f"hil_{secrets.token_hex(6)}"
        self._run("createdb", "-h", self._folder, "-U", "hil", name)
        return f"postgresql://hil@/{name}?host={self._folder}"

    def sql(self, url: str, statement: str) -> str:
        """What the server answers to a statement."""
        name = url.partition("@/")[2].partition("?")[0]
        return self._run("psql", "-h", self._folder, "-U", "hil", "-d", name, "-Atc", statement).strip()

    def _run(self, program: str, *arguments: object) -> str:
        return self._run_at(str(self._programs / program), *arguments)

    def _run_at(self, program: str, *arguments: object) -> str:
        command = [program, *map(str, arguments)]
        if os.geteuid() == 0:
            command = ["runuser", "-u", _ACCOUNT, "--", *command]
        # its output goes to a file: the server would keep a pipe open
        with tempfile.TemporaryFile("w+") as said:
            done = subprocess.run(
                command,
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=said,
                cwd="/",
                timeout=60,
                check=False,
                env={**os.environ, "PGPORT": str(self._port or 5432)},
            )
            said.seek(0)
            text = said.read()
        assert done.returncode == 0, text
        return text


def programs() -> Path | None:
    """Where the newest installed server's programs are; None if there is none."""
    found = sorted(_PLACES.glob("*/bin/initdb"), key=lambda path: float(path.parts[-3]))
    if found:
        return found[-1].parent
    elsewhere = shutil.which("initdb")
    return Path(elsewhere).resolve().parent if elsewhere else None


def install() -> None:
    """Install Debian's package, where that may be done."""
    if programs() is None and os.geteuid() == 0 and shutil.which("apt-get"):
        subprocess.run(["apt-get", "-qq", "update"], check=False)
        command = ["apt-get", "install", "-y", "-qq", "--no-install-recommends", "postgresql"]
        environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
        subprocess.run(command, check=False, stdout=subprocess.DEVNULL, env=environment)


@contextlib.contextmanager
def cluster(port: int = 0) -> Iterator[Cluster]:
    """A server that runs; the test is skipped where none can be had."""
    place = programs()
    if place is None:
        pytest.skip("PostgreSQL is not installed; as root on Debian `make service-stores` installs it")
    # a socket's path is short, and its server's account has to come there
    with tempfile.TemporaryDirectory(prefix="hil-pg-") as name:
        folder = Path(name)
        if os.geteuid() == 0:
            shutil.chown(folder, _ACCOUNT)
        folder.chmod(0o755)
        server = Cluster(folder, place, port)
        server.begin()
        try:
            yield server
        finally:
            with contextlib.suppress(AssertionError):  # a test may have ended it
                server.end()


if __name__ == "__main__":
    install()
    print(f"PostgreSQL: {programs() or 'cannot be had; as root on Debian it is installed'}")
