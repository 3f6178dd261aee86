"""Runs tests/can_vm and tests/transports/test_socketcan.py in an emulated machine with CAN controllers.

`make test-can-vm`; `python -m tests.can_vm FILE…` runs others. Installs what is missing where it may; where
it cannot run it says so in capitals and what is missing, and counts as passed, unless HIL_CAN_VM=required.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.can_vm import disk

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
CACHE = Path(os.environ.get("CAN_VM_CACHE", Path.home() / ".cache" / "hil-can-vm"))
NEEDED = {
    "qemu-system-x86_64": "qemu-system-x86",
    "candump": "can-utils",
    "ip": "iproute2",
    "dpkg": "dpkg",
    "apt-get": "apt",
    "mke2fs": "e2fsprogs",
}
_CANNOT_BOOT = 77  # of machine.sh: no kernel to be had

# An emulated processor is no real one: what is compiled for any is compiled here, beforehand.
ANY_PROCESSOR = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
INSIDE = """\
export {settings} OPENBLAS_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1
export HIL_CAN_VM_INSIDE=1 HIL_SOCKETCAN=simcan0:simcan1
for n in 0 1 2 3; do ip link set simcan$n up txqueuelen 500 type can bitrate 1000000; done
cd {root}
for n in {packages}; do mount -o bind /mnt/out/$n $n; done
{python} -m pytest -p no:cacheprovider --color=no -q -s --durations=12 {chosen}
"""
# As it is when it begins: whoever edits a file meanwhile would let everything be compiled inside.
PACKAGES = ("hil", "drivers", "test_plans", "reports", "sim_backend", "benches", "tests")
#: Those of the gate; a minute of frames at the limit (test_at_the_limit.py) is part of the night.
TESTS = (
    "tests/can_vm/test_served_bench.py",
    "tests/transports/test_socketcan.py",
)


def missing() -> dict[str, str]:
    """Commands that are not here, with their Debian packages."""
    return {command: package for command, package in NEEDED.items() if shutil.which(command) is None}


def why_not() -> str:
    """What keeps the tests from running; '' if nothing does."""
    if sys.platform != "linux" or os.uname().machine != "x86_64":
        return "the emulated machine is for Linux on x86_64"
    left = missing()
    if left and not {"apt-get", "dpkg"} & left.keys() and os.geteuid() == 0:
        packages = sorted(set(left.values()))
        subprocess.run(["apt-get", "-qq", "update"], check=False)
        command = ["apt-get", "install", "-y", "-qq", "--no-install-recommends", *packages]
        subprocess.run(command, check=False, stdout=subprocess.DEVNULL)
        left = missing()
    if left:
        return f"missing: {', '.join(sorted(set(left.values())))} (as root, Debian's packages are installed)"
    return ""


def skipped(reason: str) -> int:
    required = os.environ.get("HIL_CAN_VM") == "required"
    print(f"\nTESTS ON EMULATED CAN CONTROLLERS {'CANNOT RUN' if required else 'SKIPPED'}: {reason}\n")
    return 1 if required else 0


def main() -> int:
    if "--tell" in sys.argv:  # what `make test` says of them
        print("not run here: tests on emulated CAN controllers (make test-can-vm; .ci/run has them)")
        left = sorted(set(missing().values()))
        print(f"  they need Debian's {', '.join(left)}" if left else "  all they need is installed")
        return 0
    reason = why_not()
    if reason:
        return skipped(reason)
    settings = {**ANY_PROCESSOR, "NUMBA_CACHE_DIR": str(CACHE / "numba")}
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for package in PACKAGES:
            shutil.copytree(ROOT / package, Path(folder, package))
        compiling = [sys.executable, "-m", "tests.can_vm.compiling", f"{folder}/figures.json"]
        subprocess.run(compiling, check=True, cwd=ROOT, env={**os.environ, **settings})
        print(f"compiled for the emulated processor: {time.monotonic() - began:.0f} s", flush=True)
        script = INSIDE.format(
            settings=" ".join(f"{name}='{value}'" for name, value in settings.items()),
            root=ROOT,
            python=sys.executable,
            packages=" ".join(PACKAGES),
            chosen=shlex.join(sys.argv[1:] or TESTS),
        )
        Path(folder, "run.sh").write_text(script)
        Path(folder, "disk").write_text("".join(f"{place}\n" for place in disk.places()))
        image = disk.made(ROOT, CACHE)
        print(f"disk image made: {time.monotonic() - began:.0f} s", flush=True)
        done = subprocess.run(
            [HERE / "machine.sh", folder], check=False, env={**os.environ, "CAN_VM_DISK": str(image)}
        )
    print(f"emulated machine: {time.monotonic() - began:.0f} s, exit code {done.returncode}")
    if done.returncode == _CANNOT_BOOT:
        return skipped("no kernel can be downloaded: apt-get update, or a Debian with linux-image-amd64")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
