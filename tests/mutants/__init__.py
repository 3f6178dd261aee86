"""What the tests notice: small faults are put into the code, one at a time, and the tests are run.

`python -m tests.mutants` (make mutants) tries 300 of each package and writes docs/reference/mutants.md;
`--package test_plans.metrics --count 40` a few of one package. `safety` is no package but the files of
limits, interlocks, the emergency stop, the way to the safe state and who watches it. `--again JSON` tries
what an earlier run did not notice, and `--minutes` ends a package early. All of it happens in a copy of the
repository.
"""
