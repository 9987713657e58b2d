"""Where things lie."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
TESTS, EXAMPLES = ROOT / "tests", ROOT / "examples"
#: real records, beside the checkout where they are there
LAB = ROOT.parent / "shared" / "lab"
