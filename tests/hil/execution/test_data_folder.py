"""One service, or one agent, keeps its data in a folder, under a name of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from hil.execution.data_folder import alone_in, name_in
from hil.service.serving import ServeRequest, serve


def test_a_second_one_is_refused_until_the_first_is_gone(tmp_path: Path) -> None:
    folder = tmp_path / "made" / "for it"
    with alone_in(folder, who="agent", fix="give another"):
        assert folder.is_dir()
        with (
            pytest.raises(BadInputError, match="another agent keeps its data here"),
            alone_in(folder, who="agent", fix="give another"),
        ):
            pass
    with alone_in(folder, who="agent", fix="give another"):
        pass


def test_a_name_is_made_once_and_is_nobody_elses(tmp_path: Path) -> None:
    names = []
    for folder in (tmp_path / "a", tmp_path / "b"):
        folder.mkdir()
        names.append(name_in(folder, "agent.id"))
        assert name_in(folder, "agent.id") == names[-1]
        assert int(names[-1], 16) >= 0
        assert len(names[-1]) == 32
    assert names[0] != names[1]


def test_a_second_service_is_refused_before_it_looks_at_what_the_first_is_beginning(tmp_path: Path) -> None:
    """A folder without its file is emptied when a service begins: here it is one that is just being made."""
    made = tmp_path / "campaigns/000001/given/campaign.yaml"
    made.parent.mkdir(parents=True)
    made.write_text("name: x")
    database = f"sqlite:///{tmp_path / 'another.sqlite'}"
    with (
        alone_in(tmp_path, who="service", fix="give another"),
        pytest.raises(BadInputError, match="another service keeps its data here"),
    ):
        serve(ServeRequest(tmp_path, ("sim",), database=database, port=0))
    assert made.read_text() == "name: x"
    assert not (tmp_path / "another.sqlite").exists()
