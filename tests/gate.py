"""Which slow tests gate a change: those that prove most in ten minutes. The others run at night.

A test that takes more than a few seconds is marked `slow`. Of those, the ones of a module below are part of
`make test-slow`, with what they prove; every other one is marked `nightly` as it is collected, and runs by
`make nightly` (tests/nightly.py). What proves what stands in docs/reference/nightly.md.
"""

from __future__ import annotations

#: Modules below tests/ whose slow tests gate, and what they prove. A name behind `::` takes single tests.
GATE = {
    "test_wheel.py": "the wheel installs and runs; plans are tests of a user's own repository",
    "transports/test_run_ends.py": "a run over each transport ends safely when its wire fails",
    "hil/cli/test_run_to_the_end.py": "results, overwriting, signals, pipes of whole runs",
    "hil/cli/test_commands.py::ctrl_c": "Ctrl-C leaves a safe bench and the data",
    "hil/cli/test_commands.py::bench_that_fails": "a bench that fails is exit code 3 and keeps the data",
    "hil/cli/test_operator_terminal.py::prompt_is_answered": "a prompt is answered, and the answer is kept",
    "hil/cli/test_identify_and_design.py": "from a recording to a model and a controller",
    "hil/cli/test_campaign.py::what_it_writes": "a campaign of simulations, interrupted and gone on with",
    "hil/cli/test_full_disk.py": "a full disk costs no evidence and leaves a safe bench",
    "hil/cli/test_kills.py::killed": "a run, its stand-in or its command that is killed leaves no torque",
    "hil/cli/test_reset.py::nobody_arms": "an emergency stop stays latched until it is reset",
    "hil/cli/test_recover.py": "what a crash left opens",
    "hil/cli/test_tune.py::test_a_controller_with_more_margin": "a tuning gives a controller with reasons",
    "hil/core/recording/test_damage.py": "damaged recordings are found out",
    "hil/engine/test_hardware_process.py": "the hardware process and its supervisor",
    "hil/engine/test_wall_clock.py": "a bench in real time",
    "hil/analysis/test_degenerate.py": "degenerate recordings end in words, in every analysis",
    "hil/analysis/diagnosis/test_diagnose.py::two_effects": "missing effects are named, held-out data agree",
    "hil/analysis/diagnosis/test_diagnose.py::unknown_line": "what has no name is described, not named",
    "hil/service/test_serve.py": "the service begins, runs, is killed and ends",
    "hil/service/test_page.py::test_a_plan_is_foreseen": "a run by the page, from forecast to report",
    "hil/service/test_stop_under_attack.py::half_open": "the emergency stop is answered under attack",
    "hil/service/test_stop_under_attack.py::killed": "a stop post that was killed is there again",
    "hil/service/test_sessions.py": "tokens end, cookies are no tokens",
    "hil/service/test_audit.py": "a row of the audit log that was changed is seen",
    "hil/service/test_client.py::exit_code": "a run over the API is one at the terminal",
    "hil/service/test_client.py::travel": "files that a plan names go with it",
    "hil/service/test_stop_post.py": "who may stop, and what repeated stops leave",
    "hil/test_base_install.py": "a base install runs plans, and names the extra of what it leaves out",
    "faults/test_faults.py": "each fault of the matrix, in one phase of a run",
    "wrong_controllers/test_wrong_controllers.py": "wrong controllers do not pass",
    "formats/test_formats.py": "files of earlier versions are read",
}


def gates(nodeid: str) -> bool:
    """Whether a slow test gates; `nodeid` is pytest's, from the repository's root."""
    below = nodeid.removeprefix("tests/")
    module, _, name = below.partition("::")
    return any(module == place.partition("::")[0] and place.partition("::")[2] in name for place in GATE)
