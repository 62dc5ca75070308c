#!/usr/bin/env python3
"""Makes worlds of the benchmark's prompts and puts their plans on contact sheets, to be looked at with one's own eyes.

    .venv/bin/python tests/plan_sheet.py --out target/sheet --seed 300 --binary target/release/d3dgen

writes `sheet.png` (all 60) and `<domain>_<n>.png` (four at a time, large enough to read). Prompts are spread over the three
sizes of each domain; which ones depends on the seed. Nothing is left out.
"""

import argparse
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
DOMAINS = ["residential", "office", "hospital"]
EACH = 20


def cases(seed):
    """Domain, number, prompt of each world: two of three prompts, another third left out for each seed."""
    found = tomllib.loads((ROOT / "service/eval/data/paper_prompts.toml").read_text())["cases"]
    for domain in DOMAINS:
        prompts = [p for case in found if case["domain"] == domain for p in case["prompts"]]
        taken = [p for k, p in enumerate(prompts) if k % 3 != seed % 3][:EACH]
        yield from ((domain, k, prompt) for k, prompt in enumerate(taken))


def sheet(pictures, columns, cell):
    """Pictures in rows of `columns`, each in a cell of (width, height) pixels."""
    rows = -(-len(pictures) // columns)
    out = Image.new("RGB", (cell[0] * columns, cell[1] * rows), "white")
    for k, path in enumerate(pictures):
        image = Image.open(path).convert("RGB")
        image.thumbnail((cell[0] - 8, cell[1] - 8), Image.LANCZOS)
        out.paste(image, ((k % columns) * cell[0], (k // columns) * cell[1]))
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="new folder for worlds and sheets")
    parser.add_argument("--seed", type=int, default=300)
    parser.add_argument("--binary", type=Path, default=ROOT / "target/release/d3dgen")
    options = parser.parse_args()
    options.out.mkdir(parents=True)

    def make(case):
        domain, k, prompt = case
        folder = options.out / f"{domain}_{k:02}"
        command = [options.binary, "generate", prompt, "--domain", domain, "--seed", str(options.seed + k)]
        made = subprocess.run([*command, "--format", "plan", "--out", folder], capture_output=True, text=True)
        return folder if made.returncode == 0 else f"{prompt} (seed {options.seed + k}): {made.stderr.strip()}"

    with ThreadPoolExecutor() as pool:
        made = list(pool.map(make, cases(options.seed)))
    failed = [m for m in made if isinstance(m, str)]
    plans = [m / "plan.png" for m in made if not isinstance(m, str)]
    for domain in DOMAINS:
        own = [p for p in plans if p.parent.name.startswith(domain)]
        for n in range(0, len(own), 4):
            sheet(own[n : n + 4], 2, (1150, 860)).save(options.out / f"{domain}_{n // 4}.png")
    sheet(plans, 6, (330, 250)).quantize(64).save(options.out / "sheet.png", optimize=True)
    print(f"{len(plans)} plans in {options.out}/sheet.png")
    for line in failed:
        print(f"failed: {line}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
