"""What somebody new does: with the wheel and nothing else installed, the code of a page runs as it stands.

    python crates/py/new_user.py docs/src/tutorial-python.md        # writes pictures into the current folder
"""

import re
import sys
import time
from pathlib import Path

start = time.perf_counter()
import anergy  # noqa: E402

anergy.examples.load("three-houses").simulate()
print(f"from import to the first result: {time.perf_counter() - start:.2f} s with {anergy.__file__}")
for page in map(Path, sys.argv[1:]):
    code = re.findall(r"^```python\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)
    exec(compile("\n".join(code), str(page), "exec"), {})
