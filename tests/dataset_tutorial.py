"""Runs docs/datasets.md as it stands: writes its files, runs its commands, and has the data set judged by the kit of acceptance checks.

    tests/dataset_tutorial.py --program target/debug/d3dgen [--kit ../shared/sims] [--seeds N]

Blocks after `<!-- file: NAME -->` are written, blocks after `<!-- run -->` are run in order in one folder, by bash -eu.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"<!-- (run|file: (\S+)) -->\n```\w+\n(.*?)```", re.S)
DATASETS = ["wards", "more", "merged"]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", type=pathlib.Path, required=True)
    arguments.add_argument("--kit", type=pathlib.Path, default=pathlib.Path("../shared/sims"))
    arguments.add_argument("--seeds", type=int, help="other number of seeds than the page has; one more for the extended set")
    given = arguments.parse_args()
    page = pathlib.Path(__file__).parent.parent / "docs" / "datasets.md"
    blocks = BLOCK.findall(page.read_text())
    assert len(blocks) >= 8, "the page has lost its marks"
    with tempfile.TemporaryDirectory() as home:
        bin = pathlib.Path(home, "bin")
        bin.mkdir()
        (bin / "d3dgen").symlink_to(given.program.resolve())
        env = {**os.environ, "PATH": f"{bin}:{os.environ['PATH']}", "D3DGEN_STORE": "", "PYTHONDONTWRITEBYTECODE": "1"}
        for kind, name, text in blocks:
            if given.seeds:
                text = text.replace("seeds = 3", f"seeds = {given.seeds}").replace("--seeds 4", f"--seeds {given.seeds + 1}")
            if kind == "run":
                subprocess.run(["bash", "-euc", text], cwd=home, env=env, check=True)
            else:
                pathlib.Path(home, name).write_text(text)
        judge(home, given.kit)


def judge(home, kit):
    worlds = sum(1 for _ in pathlib.Path(home, "some").iterdir())
    check = kit / "check_dataset.py"
    if not check.is_file():
        print(f"skipped: data sets against other readers, {kit} is not here; the page's commands ran, {worlds} worlds as folders")
        return
    said = ""
    for name in DATASETS:
        checked = subprocess.run([sys.executable, check, pathlib.Path(home, name), "--need", "world.json.gz,report.json.gz,plan.svg.gz"], capture_output=True, text=True)
        if checked.returncode and "needs pyarrow" in checked.stdout + checked.stderr:
            print("skipped: data sets against other readers, pyarrow is not here; the page's commands ran")
            return
        if checked.returncode:
            sys.exit(checked.stdout + checked.stderr)
        facts = json.loads(checked.stdout.strip().splitlines()[-1])
        facts = facts.get("facts", facts)
        said += f"{name} {facts.get('rows')} worlds in {facts.get('shards')} shards, "
    print(f"data sets accepted: {said}read by pyarrow and tarfile")


if __name__ == "__main__":
    main()
