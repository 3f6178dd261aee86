"""The paper's model and its responses, as the tests of the analysis have them."""

from tests.hil.analysis.conftest import paper_frf, paper_model, paper_recording

__all__ = ["paper_frf", "paper_model", "paper_recording"]
