"""Tables of what people who share a bench tell each other."""

from __future__ import annotations

import datetime

from sqlalchemy import Date, DateTime, Index, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from hil.service.store._tables import Base

_MOMENT = DateTime(timezone=True)


class ReservationRow(Base):
    """A bench that somebody has for themselves from a moment to another."""

    __tablename__ = "reservations"
    __table_args__ = (Index("reservations_by_end", "bench", "ends"),)

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=True)
    bench: Mapped[str] = mapped_column(String(64))
    who: Mapped[str] = mapped_column(String(100))
    begins: Mapped[datetime.datetime] = mapped_column(_MOMENT)
    ends: Mapped[datetime.datetime] = mapped_column(_MOMENT)
    reason: Mapped[str] = mapped_column(String(200))


class AdmittedRunRow(Base):
    """A run of somebody else that may start within a reservation."""

    __tablename__ = "admitted_runs"

    reservation: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    run: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)


class HandoverRow(Base):
    """A note of a shift for the next."""

    __tablename__ = "handovers"
    __table_args__ = (Index("handovers_by_bench", "bench", "id"),)

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=True)
    bench: Mapped[str] = mapped_column(String(64))
    day: Mapped[datetime.date] = mapped_column(Date)
    shift: Mapped[str] = mapped_column(String(10))
    text: Mapped[str] = mapped_column(Text)
    who: Mapped[str] = mapped_column(String(100))
    at: Mapped[datetime.datetime] = mapped_column(_MOMENT)
