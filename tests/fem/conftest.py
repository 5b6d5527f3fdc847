import sys
from pathlib import Path

# Meshes for these tests and the exact sums they are held against stand in modules of their own.
sys.path.insert(0, str(Path(__file__).parent))
