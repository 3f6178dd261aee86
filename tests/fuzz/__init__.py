"""Files and frames that somebody has damaged, at every parser: no traceback, no hang, no unbounded memory.

`targets` are the parsers, `damaging` damages what was whole, `trying` does that from a seed; `guided` lets
atheris choose by what of the parsers' code an input reaches, one parser a process.
"""
