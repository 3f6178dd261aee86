"""Who approved a folder: Ed25519 signatures over a manifest with the SHA-256 of every file in it.

Manifest and signature are two files, so that others can check them too:
`openssl pkeyutl -verify -pubin -inkey KEY.pem -rawin -in signature-….json -sigfile signature-….sig`.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import BaseModel, ConfigDict, Field

from hil.core.errors import BadInputError
from hil.core.files import read_bytes, replacing, sha256_of

if TYPE_CHECKING:  # slow to import; two commands alone need it
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey

SIGNATURE_SUFFIX = ".sig"
_PREFIX, _MANIFEST, _SIGNATURE = "signature-", ".json", SIGNATURE_SUFFIX
_MAKE_ONE = "make one: ssh-keygen -t ed25519 -f NAME"


class _Manifest(BaseModel):
    model_config = ConfigDict(frozen=True)

    format: Literal["hil signature"] = "hil signature"
    signed_by: str
    signed_at: str = Field(description="clock of the signer; not verified")
    public_key: str = Field(description="of OpenSSH's form")
    files: dict[str, str] = Field(description="SHA-256 of each file, by its path in the folder")


@dataclass(frozen=True)
class Signature:
    """A signature as it is found; `key` is the raw public key; `intact`: it signed the manifest."""

    path: Path
    signed_by: str
    signed_at: str
    key: bytes
    files: dict[str, str]
    intact: bool

    @property
    def fingerprint(self) -> str:
        """The key's fingerprint as OpenSSH shows it."""
        return fingerprint(self.key)


class BrokenSignatureError(ValueError):
    """A signature's files cannot be understood: they were changed, or are none."""


def sign_folder(
    folder: Path, key: Ed25519PrivateKey, *, by: str, at: str, overwrite: bool = False
) -> tuple[Path, Path]:
    """Sign every file of a folder and of those below it; the manifest's and the signature's file.

    Signatures of other keys stay valid: a manifest names no signatures.

    Raises:
        BadInputError: the folder holds no file, or a signature of this key (without `overwrite`).
    """
    raw = key.public_key().public_bytes_raw()
    manifest = folder / f"{_PREFIX}{hashlib.sha256(raw).hexdigest()[:8]}{_MANIFEST}"
    signature = manifest.with_suffix(_SIGNATURE)
    if not overwrite and (manifest.exists() or signature.exists()):
        raise BadInputError(
            "is already signed with this key", where=str(manifest), fix="add --overwrite to sign it again"
        )
    files = hashes_of(folder)
    if not files:
        raise BadInputError("there is no file to sign", where=str(folder), fix="name a run's folder")
    manifested = _Manifest(signed_by=by, signed_at=at, public_key=_ssh_line(raw), files=files)
    text = manifested.model_dump_json(indent=1).encode() + b"\n"
    with replacing(manifest) as one, replacing(signature) as other:
        one.write_bytes(text)
        other.write_bytes(key.sign(text))
    return manifest, signature


def signatures_in(folder: Path) -> list[Path]:
    """Manifests of a folder's signatures; of one that has lost its manifest, where that should be."""
    found = {path.with_suffix(_MANIFEST) for path in folder.glob(f"{_PREFIX}*") if _is_signature(path)}
    return sorted(found)


def is_manifest(name: str) -> bool:
    """Whether a file of this name is the manifest of a signature."""
    return name.startswith(_PREFIX) and name.endswith(_MANIFEST)


def read_signature(manifest: Path) -> Signature:
    """A signature with its manifest.

    Raises:
        BrokenSignatureError: a file of the two is missing or is not what it should be.
    """
    from cryptography.exceptions import InvalidSignature

    try:
        text = read_bytes(manifest)
        signature = read_bytes(manifest.with_suffix(_SIGNATURE))
        manifested = _Manifest.model_validate_json(text)
        key = _public(manifested.public_key.encode())
    except BadInputError as error:
        what = error.what if Path(error.where).exists() else "is missing"
        raise BrokenSignatureError(f"{Path(error.where).name} {what}") from error
    except ValueError as error:  # pydantic's too
        raise BrokenSignatureError("is not the manifest of a signature, or was changed") from error
    try:
        key.verify(signature, text)
        intact = True
    except InvalidSignature:
        intact = False
    return Signature(
        manifest,
        manifested.signed_by,
        manifested.signed_at,
        key.public_bytes_raw(),
        dict(manifested.files),
        intact,
    )


def hashes_of(folder: Path) -> dict[str, str]:
    """SHA-256 of every file of a folder and of those below it, by its path there; signatures aside."""
    files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
    return {
        path.relative_to(folder).as_posix(): sha256_of(path)
        for path in files
        if not (path.parent == folder and _is_signature(path))
    }


def fingerprint(key: bytes) -> str:
    """Fingerprint of a raw public key, as OpenSSH shows it."""
    digest = hashlib.sha256(base64.b64decode(_ssh_line(key).split()[1])).digest()
    return "SHA256:" + base64.b64encode(digest).decode().rstrip("=")


def private_key(path: Path, passphrase: Callable[[], bytes]) -> Ed25519PrivateKey:
    """The Ed25519 key in a file of OpenSSH's form or PEM; `passphrase` is called for one that is encrypted.

    Raises:
        BadInputError: there is no such key in it, or the passphrase is wrong.
    """
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key, load_ssh_private_key

    text = read_bytes(path)
    load = load_ssh_private_key if b"OPENSSH PRIVATE KEY" in text else load_pem_private_key
    try:
        try:
            key = load(text, None)
        except TypeError:  # it is encrypted
            key = load(text, passphrase())
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise BadInputError(
            "is not a private key, or the passphrase is wrong", where=str(path), fix=_MAKE_ONE
        ) from error
    if not isinstance(key, Ed25519PrivateKey):
        raise BadInputError("is not an Ed25519 key", where=str(path), fix=_MAKE_ONE)
    return key


def public_key(path: Path) -> bytes:
    """The raw Ed25519 public key in a file of OpenSSH's form (`NAME.pub`) or PEM.

    Raises:
        BadInputError: there is no such key in it.
    """
    text = read_bytes(path)
    if b"PRIVATE KEY" in text:
        raise BadInputError("is a private key", where=str(path), fix="give the public one, NAME.pub")
    try:
        return _public(text).public_bytes_raw()
    except ValueError as error:
        raise BadInputError(str(error), where=str(path), fix=f"give NAME.pub; or {_MAKE_ONE}") from error


def _public(text: bytes) -> Ed25519PublicKey:
    """The public key that a text holds; ValueError if it holds none."""
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import load_pem_public_key, load_ssh_public_key

    try:
        key = load_pem_public_key(text) if b"PUBLIC KEY" in text else load_ssh_public_key(text)
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise ValueError("is not a public key") from error
    if not isinstance(key, Ed25519PublicKey):
        raise ValueError("is not an Ed25519 key")
    return key


def _is_signature(path: Path) -> bool:
    return path.name.startswith(_PREFIX) and path.suffix in (_MANIFEST, _SIGNATURE)


def _ssh_line(raw: bytes) -> str:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    key = Ed25519PublicKey.from_public_bytes(raw)
    return key.public_bytes(Encoding.OpenSSH, PublicFormat.OpenSSH).decode()
