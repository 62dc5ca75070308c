"""Runs client programs, generated from proto/ alone, against real servers on loopback: without TLS, and with TLS and a token.

    .venv/bin/python tests/clients/run.py [--server target/debug/d3dgen] [--only python|typescript|package]

`package` is clients/typescript, built, packed and installed as users get it, with the program of its page. Every run has a server of its own with a new folder of databases. Generated code and packages go to target/clients. Where npm
is missing, the TypeScript client is left out and said so. The last line counts the runs; exit status 1 when one failed.
"""

import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

WORKSPACE = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
WORK = WORKSPACE / "target" / "clients"
READY = "listening on "
START_S = 60
CLIENT_S = 300


class Failed(Exception):
    """What went wrong, for people."""


def run(command, **options):
    """Runs a command to its end and returns what it prints; its last lines when it fails."""
    done = subprocess.run(
        [str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options
    )
    if done.returncode != 0:
        tail = "\n".join(done.stdout.splitlines()[-25:])
        raise Failed(f"{Path(str(command[0])).name} ended with {done.returncode}:\n{tail}")
    return done.stdout


def proto_files():
    return sorted((WORKSPACE / "proto" / "d3dgen" / "v1").glob("*.proto"))


def prepare_python():
    """Generates the Python code and returns the commands of client and example."""
    generated = WORK / "python"
    shutil.rmtree(generated, ignore_errors=True)
    generated.mkdir(parents=True)
    out = [f"--python_out={generated}", f"--grpc_python_out={generated}"]
    run([sys.executable, "-m", "grpc_tools.protoc", f"-I{WORKSPACE / 'proto'}", *out, *proto_files()])
    environment = {"PYTHONPATH": str(generated)}
    client = [sys.executable, HERE / "python" / "client.py"]
    example = [sys.executable, WORKSPACE / "examples" / "python" / "quickstart.py"]
    return client, example, environment, "--ca"


def prepare_typescript():
    """Installs packages, generates and checks the TypeScript code, and returns the commands of client and example."""
    folder = WORK / "typescript"
    for name in ("src", "gen", "out", "errors"):
        shutil.rmtree(folder / name, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copytree(HERE / "typescript", folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("node_modules"))
    shutil.copy(WORKSPACE / "examples" / "typescript" / "quickstart.ts", folder / "src")
    run(["npm", "ci", "--no-audit", "--no-fund", "--silent"], cwd=folder)
    # what the details of errors look like: Google's own file, which comes with the Python packages
    import google.rpc.error_details_pb2 as details

    errors = folder / "errors" / "google" / "rpc"
    errors.mkdir(parents=True)
    shutil.copy(Path(details.__file__).with_name("error_details.proto"), errors)
    buf = Path(sys.executable).with_name("buf")
    run([buf, "generate", WORKSPACE / "proto"], cwd=folder)
    run([buf, "generate", folder / "errors"], cwd=folder)
    run(["npm", "run", "--silent", "build"], cwd=folder)
    out = folder / "out" / "src"
    return ["node", out / "client.js"], ["node", out / "quickstart.js"], {}, None


def prepare_package():
    """Builds and packs clients/typescript, installs the archive in a folder of a user, and returns the command of its page's program."""
    source, folder, user = WORKSPACE / "clients" / "typescript", WORK / "package", WORK / "package_user"
    for stale in (folder / "src", folder / "gen", folder / "dist", user):
        shutil.rmtree(stale, ignore_errors=True)
    shutil.copytree(source, folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("node_modules", "gen", "dist", "*.tgz"))
    run(["npm", "ci", "--no-audit", "--no-fund", "--silent"], cwd=folder)
    run([Path(sys.executable).with_name("buf"), "generate", WORKSPACE / "proto"], cwd=folder)
    run([folder / "node_modules" / ".bin" / "tsc"], cwd=folder)
    user.mkdir()
    archive = run(["npm", "pack", "--silent", "--pack-destination", user], cwd=folder).split()[-1]
    (user / "package.json").write_text('{"private": true, "type": "module"}')
    run(["npm", "install", "--no-audit", "--no-fund", "--silent", "--prefer-offline", f"./{archive}", "@types/node@20.19.25"], cwd=user)
    page = (source / "README.md").read_text()
    (user / "program.ts").write_text(page.split("```ts\n")[1].split("```")[0])
    check = ["--module", "nodenext", "--target", "es2022", "--strict", "--skipLibCheck", "--types", "node"]
    run([folder / "node_modules" / ".bin" / "tsc", *check, "program.ts"], cwd=user)
    (user / "start.js").write_text('process.argv[2] = "http://" + process.argv[2];\nawait import("./program.js");\n')
    return None, ["node", user / "start.js"], {}, None


PLAIN, SECURE, EXAMPLE = ("plain", False, False), ("TLS and token", True, False), ("example", False, True)
CLIENTS = {
    "python": (prepare_python, [PLAIN, SECURE, EXAMPLE]),
    "typescript": (prepare_typescript, [PLAIN, SECURE, EXAMPLE]),
    "package": (prepare_package, [EXAMPLE]),
}


class Server:
    """A real server process with a folder of its own; with TLS and tokens when asked for."""

    def __init__(self, program, secure):
        self.folder = tempfile.TemporaryDirectory(prefix="d3dgen-clients-")
        folder = Path(self.folder.name)
        command = [program, "serve", "--listen", "127.0.0.1:0", "--data-dir", folder / "data"]
        self.ca = self.token = None
        if secure:
            import trustme

            authority = trustme.CA()
            certificate = authority.issue_cert("127.0.0.1", "localhost")
            self.ca = folder / "ca.pem"
            authority.cert_pem.write_to_path(self.ca)
            certificate.private_key_pem.write_to_path(folder / "key.pem")
            for i, blob in enumerate(certificate.cert_chain_pems):
                blob.write_to_path(folder / "certificate.pem", append=i > 0)
            made = run([program, "serve", "token", "clients", "--scope", "write"])
            lines = [line for line in made.splitlines() if line.startswith(("#", "[[", "name", "scope", "sha256"))]
            self.token = lines[0].removeprefix("# ")
            tls = f'[tls]\ncertificate_file = "{folder}/certificate.pem"\nkey_file = "{folder}/key.pem"\n'
            (folder / "server.toml").write_text("\n".join(["version = 1", *lines, tls]))
            command += ["--config", folder / "server.toml"]
        self.log = open(folder / "log", "w+")
        environment = {k: v for k, v in os.environ.items() if not k.startswith("D3DGEN_")}
        self.process = subprocess.Popen(
            [str(c) for c in command], stdout=subprocess.PIPE, stderr=self.log, text=True, env=environment
        )
        self.address = self._address()

    def _address(self):
        begun = time.monotonic()
        line = self.process.stdout.readline()
        if not line.startswith(READY) or time.monotonic() - begun > START_S:
            self.process.kill()
            self.process.wait()
            self.log.seek(0)
            raise Failed(f"the server did not start: {line}{self.log.read()[-2000:]}")
        return line.removeprefix(READY).strip()

    def stop(self):
        """Stops the server as an operator would; it has to end by itself, with status 0."""
        self.process.send_signal(signal.SIGTERM)
        try:
            status = self.process.wait(timeout=60)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            raise Failed("the server did not stop within 60 s of SIGTERM") from None
        finally:
            self.process.stdout.close()
            self.log.close()
            self.folder.cleanup()
        if status != 0:
            raise Failed(f"the server ended with status {status}")


def one_run(program, prepared, secure, example):
    """Runs a client, or its example, against a new server and returns what it printed."""
    client, quickstart, environment, ca_flag = prepared
    server = Server(program, secure)
    try:
        environment = {**os.environ, **environment}
        environment.pop("D3DGEN_TOKEN", None)
        command = [*quickstart, server.address] if example else [*client, server.address, WORKSPACE]
        if secure:
            environment["D3DGEN_TOKEN"] = server.token
            environment["NODE_EXTRA_CA_CERTS"] = str(server.ca)
            command += [ca_flag, server.ca] if ca_flag else [server.ca]
        printed = run(command, env=environment, cwd=server.folder.name, timeout=CLIENT_S)
    except BaseException:
        server.process.kill()
        server.process.wait()
        server.folder.cleanup()
        raise
    server.stop()
    return printed


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--server", type=Path, default=WORKSPACE / "target" / "debug" / "d3dgen")
    parser.add_argument("--only", choices=CLIENTS)
    arguments = parser.parse_args()
    program = arguments.server.resolve()
    passed = failed = 0
    left_out = ""
    for name, (prepare, runs) in CLIENTS.items():
        if arguments.only not in (None, name):
            continue
        if name != "python" and not (shutil.which("npm") and shutil.which("node")):
            left_out = ", TypeScript left out: npm is not here"
            continue
        prepared = None
        for what, secure, example in runs:
            begun = time.monotonic()
            try:
                prepared = prepared or prepare()
                printed = one_run(program, prepared, secure, example)
                passed += 1
                print(f"ok      {name:<11} {what:<14} {time.monotonic() - begun:5.1f} s")
                print("".join(f"          {line}\n" for line in printed.splitlines()), end="")
            except (Failed, OSError, subprocess.TimeoutExpired) as error:
                failed += 1
                print(f"FAILED  {name:<11} {what:<14} {error}")
    print(f"{passed} client runs passed, {failed} failed{left_out}")
    sys.exit(1 if failed or not passed else 0)


if __name__ == "__main__":
    main()
