"""A table of the numbers that stand in one vector: each is declared once and gets the next place."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """What stands at one place of a vector."""

    name: str
    unit: str
    meaning: str


class Table:
    """Declarations in order. A place is a plain int, which is what the compiler turns into a constant."""

    def __init__(self) -> None:
        self.entries: list[Entry] = []

    def place(self, name: str, unit: str, meaning: str) -> int:
        """Declare one more number; its index.

        Raises:
            ValueError: the name stands in the table.
        """
        if name in self.names:
            raise ValueError(f"'{name}' stands twice")
        self.entries.append(Entry(name, unit, meaning))
        return len(self.entries) - 1

    @property
    def names(self) -> tuple[str, ...]:
        """Names in order of their places."""
        return tuple(entry.name for entry in self.entries)

    def __len__(self) -> int:
        return len(self.entries)
