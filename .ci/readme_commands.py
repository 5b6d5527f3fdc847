"""Print the commands of the README, one a line: every line of its ```sh blocks."""

import re
import sys
from pathlib import Path

text = Path(sys.argv[1]).read_text(encoding="utf-8")
blocks = re.findall(r"^```sh\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
commands = [line for block in blocks for line in block.splitlines() if line.strip() and not line.startswith("#")]
if not commands:
    sys.exit(f"{sys.argv[1]}: no ```sh block with a command in it")
print("\n".join(commands))
