"""Plan files as tests: one for the run itself, one for each criterion, one for the safe state."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from hil.pytest_plugin._ran import Ran, in_words, is_bad, properties, troubles
from hil.pytest_plugin._runs import (
    CutOffError,
    Folders,
    bench_for,
    folder_name,
    refuse_unnamed_hardware,
    run_once,
    run_plan,
)


class PlanFile(pytest.File):
    """A plan: its run and the tests of what it found."""

    _outcome: Ran | Exception | None = None

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
            refuse_unnamed_hardware(self.config, self.bench)
        except HilError as error:
            raise self.CollectError(str(error)) from None
        names = ["run", *(criterion.id for criterion in plan.criteria), "safe_state"]
        for name in names:
            item = PlanItem.from_parent(self, name=name)
            item.add_marker(pytest.mark.xdist_group(str(self.path)))  # one run, one process
            yield item

    @property
    def bench(self) -> str:
        """Where it is run."""
        found = bench_for(self.config, self.path.parent)
        assert found is not None
        return found

    def ran(self) -> Ran:
        """The run: made when the first of the tests asks for it, and never again in this session.

        Raises:
            HilError: it failed.
            CutOffError: a timeout or an interrupt of an earlier test ended it.
            BaseException: what ended this test while the run lasted; the bench is safe.
        """
        if self._outcome is None:
            try:
                self._outcome = run_once(self.config, self.nodeid, self._start)
            except Exception as error:
                self._outcome = error
            except BaseException as error:  # pytest's own and of the system: not this file's to keep
                self._outcome = CutOffError(f"the run was cut off: {error}")
                raise
        if isinstance(self._outcome, Exception):
            raise self._outcome
        return self._outcome

    def _start(self, held: Sequence[int]) -> Ran:
        out, overwrite = self.config.getoption("--bench-out"), self.config.getoption("--bench-overwrite")
        if out:
            folder = Folders(Path(out).absolute(), overwrite=overwrite).next(folder_name(self.nodeid))
        else:
            factory: Any = self.config._tmp_path_factory  # type: ignore[attr-defined]
            folder = factory.mktemp(self.path.name.partition(".")[0]) / "run"
        return run_plan(self.config, self.path, self.bench, folder, overwrite=overwrite, held=held)


class PlanItem(pytest.Item):
    """One of a plan's tests."""

    parent: PlanFile

    def runtest(self) -> None:
        """Raises:
        AssertionError: a limit is not kept, with value and limits; or the run failed.
        """
        try:
            ran = self.parent.ran()
        except Exception as error:
            if self.name != "run":
                pytest.skip(f"the plan has no result: {error}")
            raise
        if self.name in ("run", "safe_state"):
            self.user_properties += properties(ran)
            wrong = [text for kind, text in troubles(ran) if kind == self.name]
            if wrong:
                raise AssertionError("\n".join([*wrong, f"in {ran.folder}"]))
            return
        criterion = ran[self.name]
        self.user_properties += properties(ran, criterion)
        if is_bad(criterion) and criterion.verdict != "not_judged":
            definition = f"\n{criterion.definition}" if criterion.definition else ""
            raise AssertionError(f"{in_words(criterion)}{definition}\nin {ran.folder}")
        if criterion.verdict != "pass":  # nothing was demanded, or its segment was not run
            pytest.skip(in_words(criterion))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> str:
        """The message alone: where in this file it was raised helps no reader."""
        from hil.core.errors import HilError

        if isinstance(excinfo.value, AssertionError | HilError | CutOffError):
            return str(excinfo.value)
        return str(super().repr_failure(excinfo, style))

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Plan and criterion."""
        return self.path, None, f"{self.path.name}: {self.name}"
