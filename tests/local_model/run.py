#!/usr/bin/env python3
"""Worlds with the proposals of a real small language model on this machine: sound each time, whatever it says.

    run.py PROGRAM MODEL.gguf NODE_MODULES FOLDER

The model is far too small to plan buildings: this tests checking, repair and fallback with answers that nobody wrote. Prints
what became of each proposal; exit status 1 when a world is not sound or has no record.
"""

import json
import pathlib
import subprocess
import sys

PROMPTS = [
    "two-bedroom flat in Germany",
    "hospital ward with 6 rooms, for a delivery robot",
    "primary school with 4 classrooms",
]
STAGES = "scene_graph,floorplan,placement"


def made(program, folder, base_url, prompt):
    """Returns what is wrong with a world; nothing when all is well."""
    command = [program, "generate", prompt, "--no-png", "--out", str(folder), "--propose", STAGES]
    command += ["--model", "openai:local", "--base-url", base_url]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1800)
    if done.returncode != 0:
        return f"exit status {done.returncode}: {done.stderr.strip()}"
    if subprocess.run([program, "check", str(folder)], capture_output=True).returncode != 0:
        return "the world is not sound"
    record = json.loads((folder / "proposal.json").read_text())
    for stage in record["stages"]:
        counts = ", ".join(f"{n} {fate}" for fate, n in stage["counts"].items() if n)
        said = stage.get("error") or counts or "nothing proposed"
        usage = stage["usage"]
        print(f"  {stage['stage']}: {stage['outcome']} ({said}); {usage['output']} tokens in {usage['tries']} tries")
    return None if len(record["stages"]) == 3 else "the record lacks stages"


def main(program, model, modules, folder):
    server = pathlib.Path(__file__).with_name("server.mjs")
    process = subprocess.Popen(["node", str(server), model, modules], stdout=subprocess.PIPE, text=True)
    failed = 0
    try:
        port = int(process.stdout.readline())
        for number, prompt in enumerate(PROMPTS):
            print(prompt, flush=True)
            problem = made(program, pathlib.Path(folder) / str(number), f"http://127.0.0.1:{port}/v1", prompt)
            if problem:
                failed += 1
                print(f"  FAILED: {problem}")
    finally:
        process.terminate()
    print(f"local model: {len(PROMPTS) - failed} of {len(PROMPTS)} worlds sound with their record")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
