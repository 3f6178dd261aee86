"""Signatures of a folder: any changed byte of any file is found and named; other programs can check them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from cryptography.hazmat.primitives.asymmetric.ec import SECP256R1, generate_private_key
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from cryptography.hazmat.primitives.serialization import (
    BestAvailableEncryption,
    Encoding,
    NoEncryption,
    PrivateFormat,
    PublicFormat,
)
from hypothesis import given
from hypothesis import strategies as st

from hil.app.verification import of_signatures
from hil.core.errors import BadInputError
from hil.core.files.signatures import (
    fingerprint,
    private_key,
    public_key,
    read_signature,
    sign_folder,
    signatures_in,
)

KEY, OTHER = (Ed25519PrivateKey.from_private_bytes(bytes([number]) * 32) for number in (1, 2))
RAW = KEY.public_key().public_bytes_raw()


def no_passphrase() -> bytes:
    raise AssertionError("none is needed")


def signed(folder: Path) -> Path:
    (folder / "below").mkdir(parents=True)
    (folder / "report.pdf").write_bytes(b"%PDF the report")
    (folder / "below" / "data.bin").write_bytes(bytes(range(64)))
    sign_folder(folder, KEY, by="A. Tester", at="2026-03-04T09:15:00+01:00")
    return folder


def wrong(folder: Path, by: bytes | None = RAW) -> list[str]:
    return [f"{f.file.relative_to(folder)}: {f.text}" for f in of_signatures(folder, by) if not f.holds]


def test_what_was_signed_is_proven_and_signatures_of_others_leave_it_so(tmp_path: Path) -> None:
    folder = signed(tmp_path / "run")
    assert wrong(folder) == wrong(folder, None) == []
    sign_folder(folder, OTHER, by="B. Tester", at="later")
    assert wrong(folder) == []
    assert len(signatures_in(folder)) == 2
    with pytest.raises(BadInputError, match="is already signed with this key"):
        sign_folder(folder, KEY, by="A. Tester", at="again")
    third = Ed25519PrivateKey.from_private_bytes(bytes(32)).public_key().public_bytes_raw()
    assert wrong(folder, third) == [f".: has no valid signature of the key {fingerprint(third)}"]


@given(st.integers(0, 1 << 30), st.integers(0, 7))
def test_any_bit_of_any_file_is_found_and_named(tmp_path_factory, place: int, bit: int) -> None:
    folder = signed(tmp_path_factory.mktemp("signed") / "run")
    files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
    sizes = [path.stat().st_size for path in files]
    place %= sum(sizes)
    while place >= sizes[0]:
        place -= sizes.pop(0)
        files.pop(0)
    content = bytearray(files[0].read_bytes())
    content[place] ^= 1 << bit
    files[0].write_bytes(content)
    said = wrong(folder)
    assert said
    assert files[0].with_suffix("").name in said[0]


def test_files_that_come_or_go_are_named(tmp_path: Path) -> None:
    folder = signed(tmp_path / "run")
    (folder / "more.txt").write_text("added")
    (folder / "report.pdf").unlink()
    assert wrong(folder, None) == [
        "more.txt: was added after A. Tester signed",
        "report.pdf: was removed after A. Tester signed",
    ]
    next(folder.glob("*.sig")).unlink()
    assert "is missing" in wrong(folder, None)[0]


def test_keys_of_openssh_and_pem_are_read_and_others_refused(tmp_path: Path) -> None:
    forms = {
        "ssh": (Encoding.PEM, PrivateFormat.OpenSSH, NoEncryption()),
        "pem": (Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()),
        "locked": (Encoding.PEM, PrivateFormat.PKCS8, BestAvailableEncryption(b"secret")),
    }
    for name, form in forms.items():
        (tmp_path / name).write_bytes(KEY.private_bytes(*form))
        key = private_key(tmp_path / name, (lambda: b"secret") if name == "locked" else no_passphrase)
        assert key.public_key().public_bytes_raw() == RAW
    with pytest.raises(BadInputError, match="passphrase is wrong"):
        private_key(tmp_path / "locked", lambda: b"guess")
    public = KEY.public_key()
    (tmp_path / "ssh.pub").write_bytes(public.public_bytes(Encoding.OpenSSH, PublicFormat.OpenSSH) + b" me")
    (tmp_path / "pem.pub").write_bytes(public.public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo))
    assert public_key(tmp_path / "ssh.pub") == public_key(tmp_path / "pem.pub") == RAW
    curve = generate_private_key(SECP256R1()).private_bytes(*forms["pem"])
    (tmp_path / "curve").write_bytes(curve)
    (tmp_path / "rubbish").write_bytes(b"rubbish")
    for name, said in {"curve": "is not an Ed25519 key", "rubbish": "is not a private key"}.items():
        with pytest.raises(BadInputError, match=said):
            private_key(tmp_path / name, no_passphrase)
    for name, said in {"ssh": "is a private key", "rubbish": "is not a public key"}.items():
        with pytest.raises(BadInputError, match=said):
            public_key(tmp_path / name)


@pytest.mark.skipif(shutil.which("openssl") is None, reason="no openssl")
def test_openssl_checks_a_signature(tmp_path: Path) -> None:
    folder = signed(tmp_path / "run")
    public = KEY.public_key().public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo)
    (tmp_path / "key.pem").write_bytes(public)
    manifest = read_signature(signatures_in(folder)[0]).path
    verify: list[str | Path] = [
        "openssl",
        "pkeyutl",
        "-verify",
        "-pubin",
        "-inkey",
        tmp_path / "key.pem",
        "-rawin",
    ]
    files: list[str | Path] = ["-in", manifest, "-sigfile", manifest.with_suffix(".sig")]
    done = subprocess.run([*verify, *files], capture_output=True, text=True)
    assert "Verified Successfully" in done.stdout, done.stderr
