#!/usr/bin/env python3
"""Runs `d3dgen assets inspect` over files that are made to break readers, each alone and all at once.

    tests/hostile_models.py [MAKER] [--program target/release/d3dgen] [--list]

MAKER writes the files into a folder with MANIFEST.jsonl: `file`, `expect`, and limits. Of each file: no crash, an answer
within 10 s, at most 1 GiB of memory with its children (or the case's own limits), the expected outcome, nothing written
beside the folder, nothing read that is planted outside of it, no connection. Exit status 1 when one fails.
"""
import argparse
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import time

MAX_SECONDS, MAX_MIB = 10, 1024
CANARY = "canary-in-a-file-outside"


def memory_mib(pid):
    """Returns the peak memory of a process and its children so far."""
    total, open_ = 0, [pid]
    while open_:
        current = open_.pop()
        try:
            status = pathlib.Path(f"/proc/{current}/status").read_text()
            total += next(int(l.split()[1]) for l in status.splitlines() if l.startswith("VmHWM"))
            for task in pathlib.Path(f"/proc/{current}/task").iterdir():
                open_ += [int(c) for c in (task / "children").read_text().split()]
        except (OSError, StopIteration, ValueError):
            pass
    return total / 1024


def run(command, folder):
    """Returns status, output, error output, seconds and peak memory."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        begun = time.monotonic()
        process = subprocess.Popen(command, cwd=folder, stdout=out, stderr=err, stdin=subprocess.DEVNULL)
        peak = 0.0
        while process.poll() is None and time.monotonic() - begun < 120:
            peak = max(peak, memory_mib(process.pid))
            time.sleep(0.002)
        if process.poll() is None:
            process.kill()
        status = process.wait()
        seconds = time.monotonic() - begun
        out.seek(0), err.seek(0)
        return status, out.read().decode("utf-8", "replace"), err.read().decode("utf-8", "replace"), seconds, peak


def outcome(case, line):
    """Returns what is wrong with an answer, or nothing."""
    ok, expect = line["ok"], case["expect"]
    flagged = bool(line.get("warnings"))
    if not ok and not (line.get("error") or "").strip():
        return "refused without a reason"
    if not ok and pathlib.Path(case["file"]).name.split("\n")[0][:20] not in line["error"]:
        return "the refusal does not name the file"
    allowed = {
        "accept": ok,
        "accept_warn": ok,
        "accept_warn_or_reject": True,
        "reject": not ok,
        "reject_or_flag": not ok or flagged,
        "reject_or_warn": not ok or flagged,
        "no_crash": True,
        "no_hang": True,
    }
    if not allowed.get(expect, True):
        return f"expected {expect}, is {'accepted' if ok else 'refused: ' + line['error']}"
    size = case.get("size_zup")
    if ok and size and line.get("size_zup") and any(abs(a - b) > 0.002 for a, b in zip(line["size_zup"], size)):
        return f"size {line['size_zup']} not {size}"
    return None


def listens():
    """Returns a list that grows with each connection to the port that hostile files name."""
    found = []
    server = socket.socket()
    try:
        server.bind(("127.0.0.1", 9))
    except OSError:
        return found
    server.listen()

    def accept():
        while True:
            found.append(server.accept()[1])

    threading.Thread(target=accept, daemon=True).start()
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    here = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("maker", nargs="?", type=pathlib.Path, default=here / "../shared/assets/tools/make_hostile.py")
    parser.add_argument("--program", type=pathlib.Path, default=here / "target/release/d3dgen")
    parser.add_argument("--list", action="store_true", help="print every case")
    args = parser.parse_args()
    if not args.maker.is_file():
        print(f"skipped: hostile models, {args.maker} is not here")
        return 0
    connections = listens()
    program = str(args.program.resolve())
    with tempfile.TemporaryDirectory() as top:
        base = pathlib.Path(top) / "a" / "b"
        base.mkdir(parents=True)
        folder = base / "hostile"
        (base / "outside.txt").write_text(CANARY)
        subprocess.run([sys.executable, str(args.maker), str(folder), "--special"], check=True, capture_output=True)
        cases = [json.loads(l) for l in (folder / "MANIFEST.jsonl").read_text(encoding="utf-8").splitlines()]
        before = {str(p) for p in pathlib.Path(top).rglob("*")}
        wrong, slowest, largest, count = [], 0.0, 0.0, 0
        for case in cases:
            file = case["file"].replace("<ff fe 80>", "\udcff\udcfe\udc80").replace("\\n", "\n")
            if not os.path.lexists(folder / file) or file.endswith("/"):
                continue
            if os.path.isfile(folder / file) and os.geteuid() == 0 and not os.stat(folder / file).st_mode & 0o777:
                continue  # root reads what nobody may read
            count += 1
            status, out, err, seconds, peak = run([program, "assets", "inspect", "--json", "--", file], folder)
            slowest, largest = max(slowest, seconds), max(largest, peak)
            problem = None
            lines = out.splitlines()
            if status not in (0, 2) or len(lines) != 1:
                problem = f"status {status}, {len(lines)} lines: {err[-200:]}"
            elif seconds > min(MAX_SECONDS, case.get("max_seconds", MAX_SECONDS)):
                problem = f"took {seconds:.1f} s"
            elif peak > min(MAX_MIB, case.get("max_rss_mib", MAX_MIB)):
                problem = f"used {peak:.0f} MiB"
            elif CANARY in out + err or "root:x:" in out + err:
                problem = "read outside of its folder"
            elif os.path.isdir(folder / file):
                # the answer about a folder is that of its models; what else is wrong with it is said beside
                if (status == 0) != (json.loads(lines[0])["ok"] and not err.strip()):
                    problem = f"status {status} does not fit its answer and {err[-200:]!r}"
            elif (status == 0) != json.loads(lines[0])["ok"]:
                problem = f"status {status} does not fit its answer"
            else:
                problem = outcome(case, json.loads(lines[0]))
            if problem:
                wrong.append(case["file"])
            if problem or args.list:
                print(f"{case['file'][:80]!r}: {problem or 'as expected'} {json.loads(lines[0])['error'] if len(lines) == 1 else ''}"[:400])
        files = [c["file"] for c in cases if (folder / c["file"]).is_file()]
        status, out, err, seconds, peak = run([program, "assets", "inspect", "--json", "--", *files], folder)
        if status != 2 or len(out.splitlines()) != len(files):
            wrong.append("all at once")
            print(f"all at once: status {status}, {len(out.splitlines())} lines for {len(files)} files")
        after = {str(p) for p in pathlib.Path(top).rglob("*")}
        evil = [p for p in ("/tmp/asset_evil.txt", "/tmp/asset_evil_abs.txt", "pwned") if os.path.exists(p)]
        if after != before or evil:
            wrong.append("written")
            print(f"written outside: {sorted(after ^ before)[:5]} {evil}")
        if connections:
            wrong.append("connected")
            print(f"connected: {connections[:3]}")
    print(f"all at once: {len(files)} files in {seconds:.1f} s, {peak:.0f} MiB")
    print(f"hostile models: {count - len(wrong)} of {count} as expected, slowest {slowest:.1f} s, largest {largest:.0f} MiB")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
