"""What the documentation site adds to the pages of docs/: the reference, and links out of docs/ that lead to the repository."""
import importlib.util
import os
import pathlib
import posixpath
import re

from mkdocs.structure.files import File

HERE = pathlib.Path(__file__).resolve().parent
LINK = re.compile(r"(\]\()([^)\s:#]+)((?:#[^)\s]*)?\))")
MARK = re.compile(r"^<!-- (?:not run|file|run|serves)\b[^\n]*-->\n", re.M)


def on_files(files, config):
    """Adds the pages of the reference, made of the program that $D3DGEN_PROGRAM names."""
    spec = importlib.util.spec_from_file_location("reference", HERE / "reference.py")
    reference = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(reference)
    program = os.environ.get("D3DGEN_PROGRAM", str(HERE.parents[1] / "target" / "debug" / "d3dgen"))
    for name, text in reference.pages(program).items():
        files.append(File.generated(config, f"reference/{name}", content=text))
    return files


def on_page_markdown(markdown, page, config, files):
    """Leaves out the marks of the tests, and has links that lead out of docs/ lead to the repository."""
    folder = posixpath.dirname(page.file.src_uri)

    def elsewhere(link):
        target = posixpath.normpath(posixpath.join("docs", folder, link.group(2)))
        if target.startswith("docs/") or target == "docs":
            return link.group(0)
        if not (HERE.parents[1] / target).exists():
            return link.group(0)  # strict building says that it leads nowhere
        return f"{link.group(1)}{config.repo_url.rstrip('/')}/blob/main/{target}{link.group(3)}"

    return LINK.sub(elsewhere, MARK.sub("", markdown))
