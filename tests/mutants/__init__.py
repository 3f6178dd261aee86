"""What the tests notice: small faults are put into the code, one at a time, and the tests are run.

`python -m tests.mutants` (make mutants) tries 300 of each package and writes docs/reference/mutants.md;
`--package test_plans.metrics --count 40` a few of one package. All of it happens in a copy of the repository.
"""
