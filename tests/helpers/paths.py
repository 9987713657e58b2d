"""Where things lie."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "tests"
#: scenario files to start from, and their data
TEMPLATES = ROOT / "src/ratestate/scenario/templates"
#: real records, beside the checkout where they are there
LAB = ROOT.parent / "shared" / "lab"
