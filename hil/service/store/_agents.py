"""Benches that agents have registered."""

from __future__ import annotations

import datetime
from dataclasses import dataclass

from sqlalchemy import Engine, delete, select, update
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.agent import AgentBench
from hil.core.errors.wording import shortened
from hil.service.store._books import asked_apart
from hil.service.store._opening import aware, now_there
from hil.service.store._tables import AgentRow


@dataclass(frozen=True)
class RegisteredBench:
    """A bench of an agent, as it is kept."""

    agent: str
    name: str
    machine: str
    version: str
    bench: AgentBench
    heard_at: datetime.datetime
    stop_by: str = ""


@asked_apart
class AgentStore:
    """What a service has to know of agents when it begins anew; whose a bench is says `BenchStore`.

    Args:
        service: the one that hears them.
    """

    def __init__(self, engine: Engine, service: str) -> None:
        self._transaction = sessionmaker(engine, expire_on_commit=False).begin
        self._service = service

    def all(self) -> list[RegisteredBench]:
        """Those that this service has heard last."""
        chosen = select(AgentRow).where(AgentRow.service == self._service).order_by(AgentRow.bench)
        with self._transaction() as session:
            return [_registered(row) for row in session.scalars(chosen)]

    def heard(self, agent: str, name: str, machine: str, version: str, bench: AgentBench) -> None:
        """Keep that a bench's agent is there; a stop that waits for it stays."""
        with self._transaction() as session:
            row = session.get(AgentRow, bench.name) or AgentRow(bench=bench.name, stop_by="")
            row.agent, row.name, row.machine, row.version = agent, name, machine, version
            row.service, row.facts = self._service, bench.model_dump_json()
            row.heard_at = now_there(session)
            session.add(row)

    def stop(self, bench: str, by: str) -> None:
        """Keep that its agent has to learn of an emergency stop; `by` is '' once it has confirmed that."""
        with self._transaction() as session:
            session.execute(
                update(AgentRow).where(AgentRow.bench == bench).values(stop_by=shortened(by, 100))
            )

    def forget(self, bench: str) -> None:
        """It is no agent's any more."""
        with self._transaction() as session:
            session.execute(delete(AgentRow).where(AgentRow.bench == bench))


def _registered(row: AgentRow) -> RegisteredBench:
    heard_at = aware(row.heard_at)
    assert heard_at is not None
    bench = AgentBench.model_validate_json(row.facts)
    return RegisteredBench(row.agent, row.name, row.machine, row.version, bench, heard_at, row.stop_by)
