"""The bench in pytest: plan files are tests, a fixture runs plans from tests (docs/how-to/pytest.md).

pytest imports this at every start, wherever the project is installed: all else is imported when it is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from hil.pytest_plugin._folders import Folders, folder_name, leave_if_empty

if TYPE_CHECKING:
    from hil.core.recording import Recording
    from hil.core.result import CriterionResult, RunResult

_PLAN, _PLAN_ENDINGS, _BENCH = "plan.yaml", (".plan.yaml", ".plan.yml"), "bench.toml"
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
    found = _bench_for(config, config.invocation_params.dir)
    return f"bench: {found}" if found else None


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> PlanFile | None:
    """A plan.yaml or *.plan.yaml for which there is a bench."""
    if file_path.name != _PLAN and not file_path.name.endswith(_PLAN_ENDINGS):
        return None
    if _bench_for(parent.config, file_path.parent) is None:
        return None
    return PlanFile.from_parent(parent, path=file_path)


@dataclass(frozen=True)
class Ran:
    """A run that has ended: what was judged, and where its recording and reports are.

    `trouble` is what the command printed if the bench failed.
    """

    result: RunResult
    folder: Path
    trouble: str = ""

    def __getitem__(self, criterion: str) -> CriterionResult:
        """A criterion by its id: its value, limits and verdict; KeyError names those there are."""
        for one in self.result.criteria:
            if one.id == criterion:
                return one
        raise KeyError(f"{criterion}: there are {', '.join(one.id for one in self.result.criteria)}")

    @cached_property
    def recording(self) -> Recording:
        """What was measured."""
        from hil.core.recording import read_recording

        return read_recording(self.folder / self.result.files["recording"])

    def check(self) -> None:
        """Assert that the run came to its end, left the bench safe and kept every limit.

        Raises:
            AssertionError: all that is wrong, with values and limits.
        """
        __tracebackhide__ = True
        wrong = [*_wrong_with(self), *(_in_words(one) for one in self.result.criteria if _is_bad(one))]
        if wrong or self.result.verdict not in ("pass", "done"):
            raise AssertionError("\n".join([*(wrong or [self.result.verdict]), f"in {self.folder}"]))


class PytestBench:
    """The fixture `bench`: runs plans, each into a folder of its own."""

    def __init__(
        self, bench: str, folders: Folders, beside: Path, properties: list[tuple[str, object]]
    ) -> None:
        self.name = bench
        self._folders, self._beside, self._properties = folders, beside, properties

    def run(self, plan: str | Path, *, variables: Mapping[str, float] | None = None, **options: str) -> Ran:
        """Execute a plan as `hil run` does; criteria stand among the test's JUnit properties.

        Args:
            plan: a file, relative to the test's, or the name of a built-in plan.
            variables: values of the plan's variables, in their units.
            options: further options of `hil run`, such as `operator="…"` or `yes="…"`.

        Raises:
            BadInputError: plan, bench or an option cannot be used.
        """
        beside = self._beside / plan
        ran = _run(
            beside if beside.is_file() else plan,
            self.name,
            self._folders.next(Path(plan).name.partition(".")[0]),
            variables,
            options,
            overwrite=self._folders.overwrite,
        )
        self._properties += _properties(ran, *ran.result.criteria)
        return ran


@pytest.fixture
def bench(request: pytest.FixtureRequest, tmp_path: Path) -> PytestBench:
    """The bench of --bench, of the ini option hil_bench, or of the bench.toml beside the test or here."""
    from hil.core.errors import HilError

    found = _bench_for(request.config, request.path.parent)
    if found is None:
        pytest.skip(_NO_BENCH)
    try:
        _refuse_unnamed_hardware(request.config, found)
    except HilError as error:
        pytest.fail(str(error), pytrace=False)
    out = request.config.getoption("--bench-out")
    place = Path(out).absolute() / folder_name(request.node.nodeid) if out else tmp_path / "bench"
    folders = Folders(place, overwrite=request.config.getoption("--bench-overwrite"))
    return PytestBench(found, folders, request.path.parent, request.node.user_properties)


class PlanFile(pytest.File):
    """A plan: a test for the run itself, one for each criterion, one for the safe state."""

    def collect(self) -> Iterator[PlanItem]:
        """Raises:
        CollectError: the plan or the bench file has mistakes; all of them.
        """
        from hil.core.errors import HilError
        from hil.engine.bench.bench_file import load_bench
        from test_plans import load_plan

        try:
            plan = load_plan(self.path)
            load_bench(self.bench)
            _refuse_unnamed_hardware(self.config, self.bench)
        except HilError as error:
            raise self.CollectError(str(error)) from None
        names = ["run", *(criterion.id for criterion in plan.criteria), "safe_state"]
        for name in names:
            item = PlanItem.from_parent(self, name=name)
            item.add_marker(pytest.mark.xdist_group(str(self.path)))  # one run, one process
            yield item

    @property
    def bench(self) -> str:
        """Where it is executed."""
        found = _bench_for(self.config, self.path.parent)
        assert found is not None
        return found

    @cached_property
    def ran(self) -> Ran | Exception:
        """The run, executed when the first of the tests asks for it."""
        out, overwrite = self.config.getoption("--bench-out"), self.config.getoption("--bench-overwrite")
        if out:
            folder = Folders(Path(out).absolute(), overwrite=overwrite).next(folder_name(self.nodeid))
        else:
            factory: Any = self.config._tmp_path_factory  # type: ignore[attr-defined]
            folder = factory.mktemp(self.path.name.partition(".")[0]) / "run"
        try:
            return _run(self.path, self.bench, folder, None, {}, overwrite=overwrite)
        except Exception as error:
            return error


class PlanItem(pytest.Item):
    """One of a plan's tests."""

    parent: PlanFile

    def runtest(self) -> None:
        """Raises:
        AssertionError: a limit is not kept, with value and limits; or the run failed.
        """
        ran = self.parent.ran
        if isinstance(ran, Exception):
            if self.name != "run":
                pytest.skip("the plan was not executed")
            raise ran
        if self.name in ("run", "safe_state"):
            self.user_properties += _properties(ran)
            wrong = [text for kind, text in _troubles(ran) if kind == self.name]
            if wrong:
                raise AssertionError("\n".join([*wrong, f"in {ran.folder}"]))
            return
        criterion = ran[self.name]
        self.user_properties += _properties(ran, criterion)
        if _is_bad(criterion) and criterion.verdict != "not_judged":
            definition = f"\n{criterion.definition}" if criterion.definition else ""
            raise AssertionError(f"{_in_words(criterion)}{definition}\nin {ran.folder}")
        if criterion.verdict != "pass":  # nothing was demanded, or its segment was not executed
            pytest.skip(_in_words(criterion))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> str:
        """The message alone: where in this file it was raised helps no one."""
        from hil.core.errors import HilError

        if isinstance(excinfo.value, AssertionError | HilError):
            return str(excinfo.value)
        return str(super().repr_failure(excinfo, style))

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Plan and criterion."""
        return self.path, None, f"{self.path.name}: {self.name}"


def _bench_for(config: pytest.Config, folder: Path) -> str | None:
    """A bench file's path, or the name of a shipped one."""
    given = config.getoption("--bench")
    if given:
        return _placed(given, config.invocation_params.dir)
    setting = config.getini("hil_bench")
    if setting:
        return _placed(setting, config.inipath.parent if config.inipath else config.rootpath)
    own = (place / _BENCH for place in (folder, config.invocation_params.dir))
    return next((str(file) for file in own if file.is_file()), None)


def _refuse_unnamed_hardware(config: pytest.Config, found: str) -> None:
    """Raises:
    BadInputError: a bench.toml that no one has named describes hardware.
    """
    if not config.getoption("--bench") and not config.getini("hil_bench"):
        from hil.engine.bench.found_bench import refuse_hardware

        refuse_hardware(Path(found))


def _placed(bench: str, base: Path) -> str:
    return str(base / bench) if bench.endswith(".toml") else bench


def _run(
    plan: str | Path,
    bench: str,
    folder: Path,
    variables: Mapping[str, float] | None,
    options: Mapping[str, str],
    *,
    overwrite: bool,
) -> Ran:
    """A run by the command, in a process that leaves the bench safe whatever becomes of pytest."""
    from hil import notebook
    from hil.core.errors import BenchError, HilError
    from hil.core.result import RunResult

    words = [word for name, value in options.items() for word in (f"--{name.replace('_', '-')}", value)]
    words += ["--overwrite"] if overwrite else []
    try:
        ran = notebook.run(plan, folder, bench, variables=dict(variables or {}), options=words)
        return Ran(ran.result, folder)
    except HilError as error:
        stored = folder / "result.json"
        if not isinstance(error, BenchError) or not stored.is_file():
            leave_if_empty(folder)
            raise
        return Ran(RunResult.model_validate_json(stored.read_bytes()), folder, str(error))


def _troubles(ran: Ran) -> Iterator[tuple[str, str]]:
    """What is wrong with the run itself: 'run' or 'safe_state', and words."""
    if ran.trouble or ran.result.reason:
        yield "run", ran.trouble or ran.result.reason
    if ran.result.safe_state == "not_confirmed":
        yield "safe_state", "the bench did not confirm its safe state after the run: treat it as live"


def _wrong_with(ran: Ran) -> list[str]:
    return [text for _, text in _troubles(ran)]


def _is_bad(criterion: CriterionResult) -> bool:
    return criterion.failed or criterion.verdict in ("error", "not_judged")


def _in_words(criterion: CriterionResult) -> str:
    """A criterion with its value and limits, on a line."""
    from reports import quantities
    from reports.criteria import in_words

    if criterion.verdict == "informational":
        return f"{criterion.id}: informational: {quantities.quantity(criterion.value, criterion.unit)}"
    return f"{criterion.id}: {criterion.verdict.replace('_', ' ')}: {in_words(criterion)}"


def _properties(ran: Ran, *criteria: CriterionResult) -> list[tuple[str, object]]:
    """For JUnit: the run's files, and what was found and allowed."""
    found: list[tuple[str, object]] = [("bench", ran.result.bench), ("folder", str(ran.folder))]
    for one in criteria:
        figures = {"value": one.value, "lower": one.lower, "upper": one.upper, "margin": one.margin}
        found += [(f"{one.id}.{key}", repr(value)) for key, value in figures.items() if value is not None]
        found += [(f"{one.id}.unit", one.unit), (f"{one.id}.verdict", one.verdict)]
    return found
