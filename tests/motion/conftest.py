import sys
from pathlib import Path

# Bodies for these tests, and the equations of motion written a second time, stand in modules of their own.
sys.path.insert(0, str(Path(__file__).parent))
