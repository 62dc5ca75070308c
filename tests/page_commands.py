"""Runs the commands of the pages as they stand: each page in a folder of its own, as somebody who follows it from top to bottom.

    tests/page_commands.py --program target/debug/d3dgen [PAGE...]

Blocks of `sh` are run in order by bash -euo pipefail. In a block of `console`, the lines after `$ ` are run, and the lines below each
must be among what it prints; `...` stands for anything. What stands before a block, in a comment, changes that:

    <!-- file: NAME -->       the block is written to that file
    <!-- not run: REASON -->  the block is left out; the reason is counted
    <!-- serves -->           the block goes on: it is started, must say that it listens, and is stopped at the end of the page

A block that begins with a command of ours has to be one of these. Programs that a page installs are not installed here.
"""
import argparse
import concurrent.futures
import os
import pathlib
import re
import signal
import stat
import subprocess
import sys
import tempfile
import time

WORKSPACE = pathlib.Path(__file__).resolve().parents[1]
BLOCK = re.compile(r"(?:<!-- (?P<mark>[a-z ]+)(?:: (?P<said>[^\n]*?))? -->\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```", re.S | re.M)
COMMANDS = re.compile(r"^(\$ )?(d3dgen|cargo|\./tests/run|pip|npm) ", re.M)
ELSEWHERE = {"docs/datasets.md": "tests/dataset_tutorial.py"}
"""Pages whose blocks another test runs."""
BLOCK_S = 300
SERVER_S = 60
CARGO = """#!/bin/sh
# the program is built already
[ "$1 $2 $3" = "run --release --" ] || { echo "pages run no cargo $*" >&2; exit 1; }
shift 3
exec d3dgen "$@"
"""


class Failed(Exception):
    """What is wrong with a page."""


def pages():
    """Returns all pages that users read, with their paths in the checkout."""
    found = [WORKSPACE / "README.md", WORKSPACE / "python" / "README.md", WORKSPACE / "clients" / "typescript" / "README.md"]
    found += sorted((WORKSPACE / "docs").rglob("*.md")) + sorted((WORKSPACE / "ros2").rglob("README.md"))
    return [page for page in found if page.is_file() and "reviews" not in page.parts]


def run(text, home, env):
    """Runs a block in a page's folder and returns what it prints."""
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", text], cwd=home, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        stdin=subprocess.DEVNULL, timeout=BLOCK_S, check=False,
    )
    return done.returncode, done.stdout


def run_well(text, home, env):
    status, said = run(text, home, env)
    if status != 0:
        raise Failed(f"ended with {status}:\n{said[-2000:]}")


def run_shown(text, home, env):
    """Runs the commands of a session and compares what it shows of their output; they may fail, if that is what is shown."""
    for step in re.split(r"^\$ ", text, flags=re.M)[1:]:
        command, *shown = step.rstrip().splitlines()
        printed = [line.rstrip() for line in run(command, home, env)[1].splitlines()]
        missing = [line for line in shown if not any(is_shown(line.rstrip(), said) for said in printed)]
        if missing:
            raise Failed(f"{command}\nshows\n  {missing[0]}\nand prints\n" + "\n".join(printed[-20:]))


def is_shown(line, printed):
    """Returns whether a printed line is the one that a page shows."""
    return re.fullmatch(".*".join(re.escape(part) for part in line.split("...")), printed) is not None


def serve(text, home, env):
    """Starts a block that goes on, and returns its process once it listens."""
    log = open(pathlib.Path(home, "server.log"), "w+")
    process = subprocess.Popen(["bash", "-c", "exec " + text.strip()], cwd=home, env=env, stdout=log, stderr=log, text=True)
    begun = time.monotonic()
    while process.poll() is None and time.monotonic() - begun < SERVER_S:
        if "listening on" in pathlib.Path(log.name).read_text():
            return process
        time.sleep(0.1)
    process.kill()
    process.wait()
    raise Failed(f"does not listen: {pathlib.Path(log.name).read_text()[-1000:]}")


def stop(process):
    process.send_signal(signal.SIGTERM)
    try:
        process.wait(timeout=SERVER_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def environment(program, home):
    """Returns the environment of a new user: a home of their own, with the program and nothing of whoever runs the tests."""
    bin = pathlib.Path(home, ".bin")
    bin.mkdir()
    (bin / "d3dgen").symlink_to(program)
    (bin / "cargo").write_text(CARGO)
    (bin / "cargo").chmod(stat.S_IRWXU)
    python = pathlib.Path(sys.executable).parent
    env = {k: v for k, v in os.environ.items() if not k.startswith(("D3DGEN_", "XDG_"))}
    return {**env, "HOME": str(home), "PATH": f"{bin}:{python}:{env['PATH']}", "PYTHONDONTWRITEBYTECODE": "1"}


def follow(page, program):
    """Follows a page; returns how many blocks ran and the reasons of those that did not."""
    ran, left_out, servers = 0, [], []
    text = page.read_text()
    with tempfile.TemporaryDirectory(prefix="d3dgen-page-") as home:
        env = environment(program, home)
        try:
            for block in BLOCK.finditer(text):
                mark, said, language, inside = block.group("mark", "said", "language", "text")
                line = text[: block.start()].count("\n") + 1
                try:
                    if mark == "file":
                        target = pathlib.Path(home, said)
                        target.parent.mkdir(parents=True, exist_ok=True)
                        target.write_text(inside)
                        continue
                    if mark == "not run" and said:
                        left_out.append(said)
                        continue
                    if mark == "serves":
                        servers.append(serve(inside, home, env))
                    elif language == "sh":
                        run_well(inside, home, env)
                    elif language == "console":
                        run_shown(inside, home, env)
                    elif language == "" and COMMANDS.search(inside):
                        raise Failed("has commands and is neither sh nor console")
                    else:
                        continue
                    ran += 1
                except (Failed, subprocess.TimeoutExpired) as error:
                    raise Failed(f"{page.relative_to(WORKSPACE)}:{line}: {error}") from None
        finally:
            for process in servers:
                stop(process)
    return ran, left_out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=WORKSPACE / "target" / "debug" / "d3dgen")
    parser.add_argument("--reasons", action="store_true", help="list why blocks were left out")
    parser.add_argument("pages", nargs="*", type=pathlib.Path)
    given = parser.parse_args()
    program = given.program.resolve(strict=True)
    wanted = [page.resolve() for page in given.pages] or [
        page for page in pages() if str(page.relative_to(WORKSPACE)) not in ELSEWHERE
    ]
    ran, left_out, faults = 0, [], []

    def timed(page):
        begun = time.monotonic()
        return *follow(page, program), time.monotonic() - begun

    with concurrent.futures.ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        for page, future in [(page, pool.submit(timed, page)) for page in wanted]:
            try:
                count, reasons, seconds = future.result()
            except Failed as fault:
                faults.append(str(fault))
                print(f"FAILED {fault}", flush=True)
                continue
            ran += count
            left_out += [f"{page.relative_to(WORKSPACE)}: {reason}" for reason in reasons]
            if count:
                print(f"{str(page.relative_to(WORKSPACE)):<40} {count:>3} blocks {seconds:6.1f} s", flush=True)
    if given.reasons:
        print("\n".join(left_out))
    print(f"{ran} blocks of {len(wanted)} pages ran as they stand, {len(left_out)} cannot be run here, {len(faults)} faults")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
