"""Drives `d3dgen mcp` with the official Python SDK of the Model Context Protocol, as an agent would.

    .venv/bin/python tests/mcp_client.py [--program target/debug/d3dgen]

A world is made, looked at, changed, judged and exported by tool calls alone; bad calls are answered in words. The last line
says what passed; exit status 1 when something failed.
"""

import argparse
import asyncio
import base64
import json
import os
import sys
import tempfile
from pathlib import Path

from mcp import ClientSession, StdioServerParameters
from mcp.client.stdio import stdio_client

PROMPT = "two-bedroom flat in Germany with a balcony, for a vacuum robot"
PNG = b"\x89PNG\r\n\x1a\n"


class Failed(Exception):
    """What went wrong, for people."""


def expect(condition, message):
    if not condition:
        raise Failed(message)


async def data(session, tool, **arguments):
    """Calls a tool and returns its data; what it says when it refuses is a failure."""
    answer = await session.call_tool(tool, arguments)
    text = next((c.text for c in answer.content if c.type == "text"), "")
    expect(not answer.is_error, f"{tool}: {text}")
    expect(text and answer.structured_content is not None, f"{tool}: says nothing")
    return answer.structured_content


async def refusal(session, tool, **arguments):
    """Returns what a tool says when it refuses."""
    answer = await session.call_tool(tool, arguments)
    expect(answer.is_error, f"{tool} took {arguments}")
    return answer.content[0].text


async def picture(session, tool, **arguments):
    """Returns the picture in an answer."""
    answer = await session.call_tool(tool, arguments)
    images = [base64.b64decode(c.data) for c in answer.content if c.type == "image"]
    expect(images and images[0].startswith(PNG), f"{tool}: no picture")
    return images[0]


async def whole_way(session, folder):
    """From a sentence to a changed world in a simulator's format."""
    brief = await data(session, "brief", prompt=PROMPT)
    expect(brief["asks"], "brief: understood nothing")
    made = await data(session, "generate", prompt=PROMPT, name="flat", seed=3)
    expect(made["sound"] and made["asks"], f"generate: {made}")
    expect((folder / "flat" / "world.json").is_file(), "generate: wrote no world")
    expect((await data(session, "worlds"))["worlds"] == ["flat"], "worlds: not the one that was made")
    await picture(session, "plan", world="flat")

    rooms = (await data(session, "rooms", world="flat"))["rooms"]
    bedroom = next(r["room_id"] for r in rooms if "bedroom" in r["room_type"])
    before = (await data(session, "objects", world="flat", room_id=bedroom))["objects"]
    taken = next(o for o in before if "rug" in o["object"] or "plant" in o["object"] or "lamp" in o["object"])
    edits = [{"op": "remove_object", "placement_id": taken["placement_id"]}]
    changed = await data(session, "edit", world="flat", edits=edits, name="flat_2")
    expect(changed["judged"]["sound"], f"edit: {changed}")
    after = (await data(session, "objects", world="flat_2", room_id=bedroom))["objects"]
    expect(taken["placement_id"] not in [o["placement_id"] for o in after], "edit: the object is still there")
    expect(len(await data(session, "worlds")) and (folder / "flat" / "world.json").is_file(), "edit: the old world is gone")

    judged = await data(session, "check", world="flat_2")
    expect(judged["sound"] and judged["hard_rules"] > 20 and judged["asks"], f"check: {judged}")
    exported = await data(session, "export", world="flat_2", formats=["nav2"])
    expect(any((folder / "flat_2" / "nav2").iterdir()), f"export: {exported}")


async def same_bytes(session, folder):
    """The same prompt and seed give the same world."""
    await data(session, "generate", prompt=PROMPT, name="again", seed=3)
    first = json.loads((folder / "flat" / "world.json").read_text())
    again = json.loads((folder / "again" / "world.json").read_text())
    first["name"] = again["name"]
    expect(first["placements"] == again["placements"] and first["floorplan"] == again["floorplan"], "another world")


async def searches(session):
    """Rules with their sources, and models."""
    rules = (await data(session, "rules", words="clear width of a door for wheelchairs", country="DE", limit=5))["rules"]
    expect(rules and all(r["source"]["title"] for r in rules), f"rules: {rules}")
    assets = (await data(session, "assets", words="armchair", limit=3))["assets"]
    expect(len(assets) == 3, f"assets: {assets}")


async def refusals(session, folder):
    """Bad calls are answered in words that say what to do, and nothing is written."""
    expect("flat" in await refusal(session, "check", world="none_such"), "check: does not name the worlds there are")
    expect("a-z" in await refusal(session, "generate", prompt=PROMPT, name="../away"), "generate: took a path as a name")
    expect("unknown field" in await refusal(session, "generate", prompt=PROMPT, name="x", colour="red"), "generate: an odd argument")
    expect("nav2" in await refusal(session, "export", world="flat", formats=["word"]), "export: does not name the formats")
    expect("remove_object" in await refusal(session, "edit", world="flat", edits=[{"op": "burn"}]), "edit: does not name what it can")
    expect(sorted(p.name for p in folder.iterdir()) == ["again", "flat", "flat_2"], "a refused call wrote something")


async def session_of(program, home):
    folder = home / "worlds"
    server = StdioServerParameters(
        command=str(program), args=["mcp", "--out", str(folder)], env={**os.environ, "D3DGEN_STORE": str(home / "store")}
    )
    async with stdio_client(server) as (read, write), ClientSession(read, write) as session:
        await session.initialize()
        tools = (await session.list_tools()).tools
        expect(all(t.description and t.input_schema["type"] == "object" for t in tools), "a tool says not what it is for")
        await whole_way(session, folder)
        await same_bytes(session, folder)
        await searches(session)
        await refusals(session, folder)
        return len(tools)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, default=Path("target/debug/d3dgen"))
    program = parser.parse_args().program.resolve()
    with tempfile.TemporaryDirectory() as home:
        try:
            count = asyncio.run(session_of(program, Path(home)))
        except* Failed as failed:
            sys.exit(f"failed: {failed.exceptions[0]}")
    print(f"an agent's session passed, {count} tools")


if __name__ == "__main__":
    main()
