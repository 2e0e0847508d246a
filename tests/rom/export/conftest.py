import pytest
from assembled import two_segments

import rom


@pytest.fixture(scope="session")
def models(table):
    """What is exported, by name."""
    return {"rod": rom.load(), "table": table, "two_segments": two_segments()}


@pytest.fixture(scope="session")
def made(models, tmp_path_factory):
    """Makes the FMU of a model, see fmus.Maker."""
    pytest.importorskip("fmpy", reason="needs FMPy (make test installs it)")
    from fmus import Maker

    return Maker(tmp_path_factory.mktemp("fmus"), models)
