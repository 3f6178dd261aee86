"""What a base install leaves out: a missing library is reported with the extra that brings it."""

from __future__ import annotations

import importlib.util

from hil.core.errors import BadInputError

#: What an extra is for, by its name in pyproject.toml.
PURPOSES = {
    "analysis": "identification, control design, tuning, diagnosis and MAT files",
    "mdf": "MDF files",
    "parquet": "Parquet and CSV files",
    "hdf5": "HDF5 files and MAT files of version 7.3",
    "tdms": "TDMS files",
    "sign": "signatures",
    "service": "the service",
    "sign-in": "signing in by OpenID Connect",
    "campaign": "campaigns in several processes or on several machines",
    "fmu": "functional mock-up units",
}
#: Which extra brings a module.
MODULES = {
    "scipy": "analysis",
    "skrf": "analysis",
    "pandas": "analysis",
    "asammdf": "mdf",
    "pyarrow": "parquet",
    "h5py": "hdf5",
    "nptdms": "tdms",
    "cryptography": "sign",
    "fastapi": "service",
    "uvicorn": "service",
    "sqlalchemy": "service",
    "alembic": "service",
    "fsspec": "service",
    "authlib": "sign-in",
    "joserfc": "sign-in",
    "requests": "sign-in",
    "dask": "campaign",
    "distributed": "campaign",
    "pythonfmu": "fmu",
}


def not_installed(error: ModuleNotFoundError, instead: str = "") -> BadInputError | None:
    """The message for a library that an extra brings; None where the module belongs to none.

    Args:
        instead: what can be done without the library.
    """
    module = (error.name or "").partition(".")[0]
    return _message(module, instead) if module in MODULES else None


def need(module: str, instead: str = "") -> None:
    """Refuse what cannot work without a library, before anything is started.

    Args:
        instead: what can be done without it.

    Raises:
        BadInputError: it is not installed; names its extra.
    """
    if importlib.util.find_spec(module) is None:
        raise _message(module, instead)


def _message(module: str, instead: str) -> BadInputError:
    extra = MODULES[module]
    install = f"pip install 'eaxle-hil[{extra}]', or 'eaxle-hil[all]'"
    return BadInputError(
        f"this needs the library '{module}', not in the base install, in the extra '{extra}' "
        f"({PURPOSES[extra]})",
        fix=f"{install}; or {instead}" if instead else install,
    )
