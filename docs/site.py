"""Hooks of mkdocs: README.md is the first page, and links into the repository lead to GitHub."""

import re
from pathlib import Path, PurePosixPath

from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parent.parent
REPOSITORY = "https://github.com/anastomesh/anastomesh/blob/main/"
TARGET = re.compile(r"\]\(([^)\s]+)\)")


def on_files(files, config):
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    files.append(File.generated(config, "index.md", content=relinked(readme, "")))
    return files


def on_page_markdown(markdown, page, config, files):
    return relinked(markdown, "docs/" + page.file.src_uri) if page.file.src_uri != "index.md" else markdown


def relinked(markdown, source):
    """Text of a page with its links as they are on the site. `source` is its path in the repository, empty for README.md."""
    folder = PurePosixPath(source).parent
    here = folder.relative_to("docs") if source else PurePosixPath()

    def target(match):
        link = match[1].removeprefix(REPOSITORY)
        if re.match(r"#|\w+:", link):
            return match[0]
        inside = PurePosixPath(link) if link != match[1] else folder / link
        parts = []
        for part in inside.parts:
            parts = parts[:-1] if part == ".." else [*parts, part]
        if parts[0] != "docs":
            return f"]({REPOSITORY}{'/'.join(parts)})"
        return f"]({'../' * len(here.parts)}{'/'.join(parts[1:])})"

    return TARGET.sub(target, markdown)
