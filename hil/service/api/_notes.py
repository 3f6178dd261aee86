"""Notes and tags of runs: what people found, and words to find runs again."""

from __future__ import annotations

from fastapi import APIRouter

from hil.api_schemas.api import LADDER, RunId
from hil.api_schemas.notes import NoteData, NoteWanted, RunNotes, Tag
from hil.core.errors.wording import shortened
from hil.service.api._access import Operator, TheService, Viewer
from hil.service.api._problems import RefusedError, missing
from hil.service.api._runs import there

router = APIRouter(prefix="/runs/{run}", tags=["runs"])


@router.get("/notes", name="get_run_notes")
async def get_run_notes(run: RunId, service: TheService, me: Viewer) -> RunNotes:
    """Notes and tags of a run."""
    del me
    there(service, run)
    return service.notes.of(run)


@router.post("/notes", name="add_run_note", status_code=201)
async def add_run_note(run: RunId, wanted: NoteWanted, service: TheService, me: Operator) -> NoteData:
    """Add a note to a run, under way or over."""
    there(service, run)
    found = service.notes.add(run, me.name, wanted.text)
    service.log.add(me.name, me.role, "note added", f"run {run}", shortened(wanted.text, 200))
    return found


@router.delete("/notes/{note}", name="remove_run_note", status_code=204)
async def remove_run_note(run: RunId, note: RunId, service: TheService, me: Operator) -> None:
    """Remove a note of one's own; engineers remove those of others."""
    found = service.notes.get(run, note)
    if found is None:
        raise missing("note", note)
    if found.who != me.name and LADDER.index(me.role) < LADDER.index("engineer"):
        raise RefusedError(403, f"the note is {found.who}'s", where=f"run {run}", fix="ask an engineer")
    service.notes.remove(note)
    service.log.add(
        me.name, me.role, "note removed", f"run {run}", f"{found.who}: {shortened(found.text, 200)}"
    )


@router.put("/tags/{tag}", name="tag_run", status_code=204)
async def tag_run(run: RunId, tag: Tag, service: TheService, me: Operator) -> None:
    """Tag a run."""
    there(service, run)
    service.notes.tag(run, tag, me.name)
    service.log.add(me.name, me.role, "tag added", f"run {run}", tag)


@router.delete("/tags/{tag}", name="untag_run", status_code=204)
async def untag_run(run: RunId, tag: Tag, service: TheService, me: Operator) -> None:
    """Take a tag off a run."""
    if not service.notes.untag(run, tag):
        raise missing("tag", tag)
    service.log.add(me.name, me.role, "tag removed", f"run {run}", tag)
