import pytest


@pytest.fixture(scope="session")
def made(models, tmp_path_factory):
    """Makes the FMU of a model, see fmus.Maker."""
    pytest.importorskip("fmpy", reason="needs FMPy (make test installs it)")
    from fmus import Maker

    return Maker(tmp_path_factory.mktemp("fmus"), models)
