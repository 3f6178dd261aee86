"""What the service keeps, in SQLite or another database by URL: made and migrated when it is opened."""

from hil.service.store._agents import AgentStore, RegisteredBench
from hil.service.store._audit import AuditCheck, AuditHead, LogStore
from hil.service.store._benches import BenchStore, LeaseStore
from hil.service.store._books import asked_apart, in_turns
from hil.service.store._durations import DurationStore
from hil.service.store._files import FileStore, KeptFile
from hil.service.store._given import GivenStore, GivenText
from hil.service.store._handovers import HandoverStore
from hil.service.store._layouts import LayoutStore
from hil.service.store._notes import NoteStore
from hil.service.store._opening import open_database
from hil.service.store._people import SESSION_S, TokenStore
from hil.service.store._presence import DatabaseAwayError, Presence
from hil.service.store._reservations import ReservationStore
from hil.service.store._results import ResultKind, ResultStore, SharedJob
from hil.service.store._run_list import RunList
from hil.service.store._runs import NewRun, RunStore
from hil.service.store._signed_in import PersonStore
from hil.service.store._tables import Base
from hil.service.store._versions import GivenVersion, VersionStore

__all__ = [
    "SESSION_S",
    "AgentStore",
    "AuditCheck",
    "AuditHead",
    "Base",
    "BenchStore",
    "DatabaseAwayError",
    "DurationStore",
    "FileStore",
    "GivenStore",
    "GivenText",
    "GivenVersion",
    "HandoverStore",
    "KeptFile",
    "LayoutStore",
    "LeaseStore",
    "LogStore",
    "NewRun",
    "NoteStore",
    "PersonStore",
    "Presence",
    "RegisteredBench",
    "ReservationStore",
    "ResultKind",
    "ResultStore",
    "RunList",
    "RunStore",
    "SharedJob",
    "TokenStore",
    "VersionStore",
    "asked_apart",
    "in_turns",
    "open_database",
]
