"""How each command is called when all is well, and which of its arguments name files."""

from __future__ import annotations

USUAL: dict[str, tuple[str, ...]] = {
    "run": ("plan.yaml", "--bench", "bench.toml", "--out", "out"),
    "check": ("plan.yaml", "--bench", "bench.toml"),
    "report": ("done", "--out", "out"),
    "identify": ("recording.mcap", "--out", "out"),
    "design": ("--model", "model.toml", "--out", "out"),
    "diagnose": ("short.csv", "--model", "model.toml", "--out", "out"),
    "simulate": ("--model", "model.toml", "--input", "short.csv", "--out", "out.csv"),
    "export": ("recording.mcap", "--out", "out.csv"),
    "replay": ("frames.log", "--bench", "bench.toml", "--out", "out"),
    "evidence verify": ("recording.mcap",),
    "evidence sign": ("done", "--key", "key.pem", "--by", "A. Tester"),
    "evidence recover": ("torn.mcap", "--out", "out.mcap"),
    "bench reset": ("bench.toml", "--by", "A. Tester"),
    "schema": ("plan",),
    "list": ("plans",),
    "init": ("new",),
    "compare": ("done", "recording.mcap", "--out", "out"),
    "explain": (
        "--target", "c.peak_shaft_torque=120", "--plan", "plan.yaml", "--bench", "bench.toml",
        "--among", "dead_time", "--evaluations", "20", "--out", "out",
    ),
    "tune": (
        "acceptance", "--model", "model.toml", "--bench", "bench.toml", "--starts", "1",
        "--at-most", "0.02", "--processes", "1", "--out", "out",
    ),
    "campaign": ("campaign.yaml", "--workers", "0", "--out", "out"),
    "bench doctor": ("bench.toml", "--for", "0.3"),
    "bench sim": ("bench.toml", "--port", "0", "--for", "0.5"),
    "serve": ("--data", "service", "--bench", "bench.toml", "--port", "0", "--for", "0.5"),
    "bench agent": (
        "--server", "http://127.0.0.1:9", "--data", "agent", "--bench", "bench.toml", "--for", "0.5",
    ),
}  # fmt: skip
COMMANDS = tuple(USUAL)
WRITING = (
    "run",
    "report",
    "identify",
    "design",
    "diagnose",
    "simulate",
    "export",
    "replay",
    "evidence recover",
    "compare",
    "explain",
    "campaign",
)

#: What an option needs beside the usual arguments, where it is not among them.
EXTRA = {
    ("run", "--model"): ("--model", "model.toml"),
    ("diagnose", "--holdout"): ("--holdout", "recording.mcap"),
    ("design", "--frf"): ("--frf", "short.csv"),
    ("serve", "--notices"): ("--notices", "notices.toml"),
    ("serve", "--sign-in"): ("--sign-in", "sign-in.toml"),
}
#: command, argument, its file, a file of another format that the user may have meant
FILE_ARGUMENTS = (
    ("run", "PLAN", "plan.yaml", "bench.toml"),
    ("run", "--bench", "bench.toml", "model.toml"),
    ("run", "--model", "model.toml", "bench.toml"),
    ("check", "PLAN", "plan.yaml", "bench.toml"),
    ("check", "--bench", "bench.toml", "model.toml"),
    ("report", "RECORDING", "recording.mcap", "model.toml"),
    ("identify", "RECORDING", "recording.mcap", "plan.yaml"),
    ("design", "--model", "model.toml", "bench.toml"),
    ("design", "--frf", "short.csv", "plan.yaml"),
    ("diagnose", "RECORDING", "short.csv", "rmcu.dbc"),
    ("diagnose", "--model", "model.toml", "plan.yaml"),
    ("diagnose", "--holdout", "recording.mcap", "short.csv"),
    ("simulate", "--model", "model.toml", "bench.toml"),
    ("simulate", "--input", "short.csv", "model.toml"),
    ("export", "RECORDING", "recording.mcap", "short.csv"),
    ("replay", "LOG", "frames.log", "plan.yaml"),
    ("replay", "--bench", "bench.toml", "model.toml"),
    ("evidence verify", "RECORDING", "recording.mcap", "short.csv"),
    ("evidence sign", "--key", "key.pem", "plan.yaml"),
    ("evidence recover", "RECORDING", "torn.mcap", "short.csv"),
    ("compare", "DIR", "recording.mcap", "short.csv"),
    ("explain", "--plan", "plan.yaml", "bench.toml"),
    ("explain", "--bench", "bench.toml", "model.toml"),
    ("campaign", "FILE", "campaign.yaml", "model.toml"),
    ("bench doctor", "BENCH", "bench.toml", "model.toml"),
    ("bench sim", "BENCH", "bench.toml", "model.toml"),
    ("serve", "--bench", "bench.toml", "model.toml"),
    ("serve", "--notices", "notices.toml", "bench.toml"),
    ("serve", "--sign-in", "sign-in.toml", "bench.toml"),
    ("bench agent", "--bench", "bench.toml", "model.toml"),
)
READ_ELSEWHERE = (
    ("run", "--model"),
    ("check", "PLAN"),
    ("check", "--bench"),
    ("diagnose", "--model"),
    ("diagnose", "--holdout"),
    ("simulate", "--model"),
    ("explain", "--plan"),
    ("explain", "--bench"),
    ("replay", "--bench"),
    ("bench doctor", "BENCH"),
    ("bench sim", "BENCH"),
    ("serve", "--bench"),
    ("bench agent", "--bench"),
)
#: Every numeric option.
NUMBERS = {
    "identify": ("--from-hz", "--to-hz", "--order", "--gear-ratio", "--hold-ms"),
    "design": (
        "--lead-deg",
        "--lead-hz",
        "--notch-hz",
        "--notch-width",
        "--notch-depth",
        "--pole",
        "--inertia",
        "--gear-ratio",
        "--wheel-inertia",
        "--torque-limit",
        "--largest-sensitivity",
    ),
    "explain": ("--evaluations", "--seed"),
    "campaign": ("--workers",),
    "bench doctor": ("--for",),
    "bench sim": ("--time-scale", "--port", "--seed"),
    "serve": ("--port", "--rate"),
}


def usual(command: str, argument: str = "") -> tuple[str, ...]:
    """The arguments of a command when all is well, with `argument` among them."""
    arguments = (*USUAL[command], *EXTRA.get((command, argument), ()))
    if (command, argument) == ("report", "RECORDING"):
        return tuple("recording.mcap" if a == "done" else a for a in arguments)
    return arguments


def with_other(arguments: tuple[str, ...], old: str, new: str) -> tuple[str, ...]:
    """The arguments with one value in place of another."""
    return tuple(new if a == old else a for a in arguments)
