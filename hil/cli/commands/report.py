"""`hil report`: the report again, from a recording alone."""

from __future__ import annotations

from hil.app.report import renew_report
from hil.app.requests import ReportRequest
from hil.app.result_file import reading_in_words
from hil.cli.inputs import request_of
from hil.cli.options.runs import Report
from hil.cli.output import TERMINAL, console, count_in_words, print_criteria, print_json
from hil.cli.streams import complain


def execute(options: Report) -> int:
    """Execute the command; its exit code."""
    renewed = renew_report(request_of(ReportRequest, options), TERMINAL)
    result, page = renewed.result, renewed.folder / renewed.files["html"]
    if result is None:
        if options.as_json:
            print_json({"verdict": None, "files": renewed.files, "read": renewed.read})
        else:
            for line in reading_in_words(renewed.read):
                console().print(line, highlight=False, markup=False, soft_wrap=True)
            text = f"no plan in {renewed.recording}: a report of its channels\nreport: {page}"
            console().print(text, highlight=False)
        return 0
    if options.as_json:
        print_json(result.model_dump(mode="json"))
    else:
        print_criteria(console(), result.criteria)
        verdict = f"{result.verdict.upper()}, {count_in_words(result.criteria)}"
        console().print(f"\n{verdict}\nreport: {page}", highlight=False)
        if result.reason:
            complain("error" if result.verdict == "error" else "note", result.reason)
    return {"pass": 0, "done": 0, "fail": 1, "error": 1}[result.verdict]
