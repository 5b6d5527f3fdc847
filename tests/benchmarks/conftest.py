import sys
from pathlib import Path

# `python tests/benchmarks/compare.py` finds its neighbours in its own folder; the tests have to be told.
sys.path.insert(0, str(Path(__file__).parent))
