"""Writes the reference as Markdown: every command by its own help, every document by its schema, every call by the contract.

    python deploy/site/reference.py --program target/debug/d3dgen --out target/reference

Needs grpcio-tools for the contract (tests/requirements.txt has it). The same program and files give the same pages.
"""
import argparse
import json
import pathlib
import re
import subprocess
import tempfile

WORKSPACE = pathlib.Path(__file__).resolve().parents[2]
PROTO = WORKSPACE / "proto"


def pages(program):
    """Returns the text of each page by its name."""
    return {"commands.md": commands(program), "documents.md": documents(), "contract.md": contract()}


def commands(program):
    """Returns the page of all commands, as `--help` prints them."""
    parts = ["# Commands\n\nEvery command as `--help` prints it; `d3dgen man COMMAND` has the same as a manual page.\n"]

    def add(words):
        text = subprocess.run([program, *words, "--help"], capture_output=True, text=True, check=True).stdout
        parts.append(f"{'#' * min(len(words) + 2, 4)} d3dgen {' '.join(words)}".rstrip() + f"\n\n```text\n{text.rstrip()}\n```\n")
        listed = re.search(r"^Commands:\n((?:  .*\n|\n)*?)(?=^\S|\Z)", text, re.M)
        for name in re.findall(r"^  ([a-z][a-z0-9-]*)(?:\s|$)", listed.group(1), re.M) if listed else []:
            if name != "help":
                add([*words, name])

    add([])
    return "\n".join(parts)


def cell(text):
    """Returns a text that stands in a cell of a table."""
    return " ".join(str(text).split()).replace("|", "\\|")


def kind(schema):
    """Returns what a field holds, in words; parts of the document are links."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[-1]
        return f"`{name}`"
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    for several in ("anyOf", "oneOf", "allOf"):
        if several in schema:
            kinds = [kind(one) for one in schema[several]]
            return " or ".join(dict.fromkeys(k for k in kinds if k != "null")) or "null"
    types = schema.get("type", "any")
    types = [t for t in ([types] if isinstance(types, str) else types) if t != "null"]
    if types == ["array"]:
        return "list of " + kind(schema.get("items", {}))
    extra = schema.get("additionalProperties")
    if types == ["object"] and isinstance(extra, dict) and "properties" not in schema:
        return "map to " + kind(extra)
    return " or ".join(types) or "null"


def fields(schema):
    """Returns the table of an object's fields, or what else the schema takes."""
    if "properties" not in schema:
        choices = schema.get("oneOf") or schema.get("anyOf") or []
        inner = [fields(one) for one in choices if "properties" in one]
        return "\n".join(inner) if inner else f"{kind(schema)}\n"
    required = set(schema.get("required", []))
    lines = ["| field | what it holds | | meaning |", "|---|---|---|---|"]
    for name, field in schema["properties"].items():
        needed = "required" if name in required else ""
        lines.append(f"| `{name}` | {cell(kind(field))} | {needed} | {cell(field.get('description', ''))} |")
    return "\n".join(lines) + "\n"


def documents():
    """Returns the page of all documents."""
    parts = ["# Documents\n\nMade of the JSON Schemas in [schemas/](../../schemas). Lengths are in m, areas in m2, angles in rad.\n"]
    for path in sorted((WORKSPACE / "schemas").glob("*.schema.json")):
        schema = json.loads(path.read_text())
        name = path.name.removesuffix(".schema.json")
        parts.append(f"## {name}\n\n{schema.get('description', '')}\n\n{fields(schema)}")
        for part, inner in schema.get("$defs", {}).items():
            parts.append(f"### {name}: {part}\n\n{inner.get('description', '')}\n\n{fields(inner)}")
    return "\n".join(parts)


def contract():
    """Returns the page of all calls and messages."""
    import grpc_tools
    from google.protobuf import descriptor_pb2
    from grpc_tools import protoc

    files = sorted(str(path.relative_to(PROTO)) for path in PROTO.rglob("*.proto"))
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder, "contract.binpb")
        own = pathlib.Path(grpc_tools.__file__).with_name("_proto")
        status = protoc.main(["protoc", f"-I{PROTO}", f"-I{own}", "--include_source_info", f"--descriptor_set_out={out}", *files])
        if status != 0:
            raise SystemExit("the contract does not compile")
        described = descriptor_pb2.FileDescriptorSet.FromString(out.read_bytes())
    parts = ["# Contract\n\nMade of the files in [proto/](../../proto). How the calls are used is told in [api.md](../api.md).\n"]
    for file in described.file:
        said = {tuple(place.path): place.leading_comments or place.trailing_comments for place in file.source_code_info.location}
        parts += [service(s, said, (6, i)) for i, s in enumerate(file.service)]
        parts += [part for i, m in enumerate(file.message_type) for part in message(m, said, (4, i), "")]
    return "\n".join(parts)


def short(name):
    return name.rsplit(".", 1)[-1]


def service(described, said, path):
    """Returns the section of a service: its calls with what goes in and comes back."""
    lines = [f"## {described.name}\n\n{said.get(path, '').strip()}\n", "| call | request | answer | what it does |", "|---|---|---|---|"]
    for i, call in enumerate(described.method):
        answer = ("stream of " if call.server_streaming else "") + f"`{short(call.output_type)}`"
        request = ("stream of " if call.client_streaming else "") + f"`{short(call.input_type)}`"
        lines.append(f"| `{call.name}` | {request} | {answer} | {cell(said.get((*path, 2, i), ''))} |")
    return "\n".join(lines) + "\n"


def message(described, said, path, above):
    """Yields the section of a message and of those inside of it."""
    from google.protobuf.descriptor_pb2 import FieldDescriptorProto

    name = above + described.name
    lines = [f"### {name}\n\n{said.get(path, '').strip()}\n"]
    if described.field:
        lines += ["| field | what it holds | meaning |", "|---|---|---|"]
    for i, field in enumerate(described.field):
        holds = short(field.type_name) or FieldDescriptorProto.Type.Name(field.type).removeprefix("TYPE_").lower()
        many = "list of " if field.label == FieldDescriptorProto.LABEL_REPEATED else ""
        lines.append(f"| `{field.name}` | {many}`{holds}` | {cell(said.get((*path, 2, i), ''))} |")
    yield "\n".join(lines) + "\n"
    for i, inner in enumerate(described.nested_type):
        if not inner.options.map_entry:
            yield from message(inner, said, (*path, 3, i), name + ".")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="d3dgen")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    for name, text in pages(given.program).items():
        (given.out / name).write_text(text)
        print(f"{given.out / name}: {len(text.splitlines())} lines")


if __name__ == "__main__":
    main()
