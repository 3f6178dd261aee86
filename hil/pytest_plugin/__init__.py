"""The bench in pytest: plan files are tests, a fixture runs plans from tests (docs/how-to/pytest.md).

pytest imports this at every start, wherever the project is installed: all else is imported when it is used.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from hil.pytest_plugin._plans import PlanFile
from hil.pytest_plugin._ran import Ran, properties
from hil.pytest_plugin._runs import Folders, bench_for, folder_name, refuse_unnamed_hardware, run_plan

__all__ = ["PlanFile", "PytestBench", "Ran", "bench"]

_PLAN, _PLAN_ENDINGS = "plan.yaml", (".plan.yaml", ".plan.yml")
_NO_BENCH = (
    "no bench: give --bench sim, --bench FILE, the ini option hil_bench, or a bench.toml beside the test"
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--bench` and `--bench-out`, and the ini option `hil_bench`."""
    group = parser.getgroup("hil", "test benches for electric axles")
    group.addoption(
        "--bench",
        metavar="BENCH",
        help="bench file, or the name of a shipped bench, such as sim; "
        "default: bench.toml beside the plan or here, if it is simulated",
    )
    group.addoption(
        "--bench-out",
        metavar="DIR",
        help="where recordings and reports go; default: pytest's temporary folder",
    )
    group.addoption(
        "--bench-overwrite",
        action="store_true",
        help="replace the results of an earlier session in --bench-out; default: new numbered folders",
    )
    parser.addini("hil_bench", "bench in place of --bench; a file is relative to this ini file")


def pytest_report_header(config: pytest.Config) -> str | None:
    """The bench of those tests that have none of their own beside them."""
    found = bench_for(config, config.invocation_params.dir)
    return f"bench: {found}" if found else None


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> PlanFile | None:
    """A plan.yaml or *.plan.yaml for which there is a bench."""
    if file_path.name != _PLAN and not file_path.name.endswith(_PLAN_ENDINGS):
        return None
    if bench_for(parent.config, file_path.parent) is None:
        return None
    return PlanFile.from_parent(parent, path=file_path)


class PytestBench:
    """The fixture `bench`: runs plans, each into a folder of its own."""

    def __init__(
        self,
        config: pytest.Config,
        bench: str,
        folders: Folders,
        beside: Path,
        properties: list[tuple[str, object]],
    ) -> None:
        self.name = bench
        self._config = config
        self._folders, self._beside, self._properties = folders, beside, properties

    def run(self, plan: str | Path, *, variables: Mapping[str, float] | None = None, **options: str) -> Ran:
        """Run a plan as `hil run` does; criteria stand among the test's JUnit properties.

        What ends the test while the run lasts (a timeout, Ctrl-C) interrupts the run, and is raised when the
        bench is safe.

        Args:
            plan: a file, relative to the test's, or the name of a built-in plan.
            variables: values of the plan's variables, in their units.
            options: further options of `hil run`, such as `operator="…"` or `yes="…"`.

        Raises:
            BadInputError: plan, bench or an option cannot be used.
        """
        beside = self._beside / plan
        ran = run_plan(
            self._config,
            beside if beside.is_file() else plan,
            self.name,
            self._folders.next(Path(plan).name.partition(".")[0]),
            variables=variables,
            options=options,
            overwrite=self._folders.overwrite,
        )
        self._properties += properties(ran, *ran.result.criteria)
        return ran


@pytest.fixture
def bench(request: pytest.FixtureRequest, tmp_path: Path) -> PytestBench:
    """The bench of --bench, of the ini option hil_bench, or of the bench.toml beside the test or here."""
    from hil.core.errors import HilError

    found = bench_for(request.config, request.path.parent)
    if found is None:
        pytest.skip(_NO_BENCH)
    try:
        refuse_unnamed_hardware(request.config, found)
    except HilError as error:
        pytest.fail(str(error), pytrace=False)
    out = request.config.getoption("--bench-out")
    place = Path(out).absolute() / folder_name(request.node.nodeid) if out else tmp_path / "bench"
    folders = Folders(place, overwrite=request.config.getoption("--bench-overwrite"))
    return PytestBench(request.config, found, folders, request.path.parent, request.node.user_properties)
