import sys
from pathlib import Path

import pytest

# The scene is a module of its own so that the scripts which the tests run and kill can import it too.
sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture
def scene():
    from toy_scene import make_scene

    return make_scene()
