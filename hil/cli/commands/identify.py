"""`hil identify`: from recordings to frequency responses, transfer functions and a driveline chain."""

from __future__ import annotations

from hil.app.identify import identify_recordings
from hil.app.requests import IdentifyRequest
from hil.app.result_file import reading_in_words
from hil.cli.inputs import request_of
from hil.cli.options.models import Identify
from hil.cli.output import TERMINAL, print_json
from reports.outputs.identification import text_of


def execute(options: Identify) -> int:
    """Execute the command; its exit code."""
    outcome = identify_recordings(request_of(IdentifyRequest, options), TERMINAL)
    if options.json_:
        print_json(outcome.summary)
    else:
        for line in reading_in_words(outcome.summary["read"]):
            print(line)
        print(text_of(outcome.found, outcome.summary, outcome.folder))
    return 0
