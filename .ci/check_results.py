"""Checks the results file of `cutpoint paper`: it is there, it is JSON, and it holds the paper's two tables."""

import json
import sys
from pathlib import Path

TABLES = ("table_3", "table_4")

path = Path(sys.argv[1])
if not path.is_file():
    sys.exit(f"{path} is missing: cutpoint paper must write it")
try:
    results = json.loads(path.read_text(encoding="utf-8"))
except ValueError as error:
    sys.exit(f"{path} is not JSON: {error}")
missing = [table for table in TABLES if not (isinstance(results, dict) and results.get(table))]
if missing:
    sys.exit(f"{path} has nothing under {', '.join(missing)}")
print(f"results.json holds {', '.join(results)}")
