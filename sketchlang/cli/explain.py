"""`sketchlang explain`: what a diagnostic means."""

from __future__ import annotations

import click

from sketchlang.cli import names
from sketchlang.cli.common import say
from sketchlang.pages import Page, pages
from sketchlang.suggest import did_you_mean


@click.command("explain")
@click.argument("code", required=False, shell_complete=names.codes)
def command(code: str | None) -> None:
    """Print the page of a diagnostic: what it means, why it matters, what to do.

    Without CODE, list all of them. Exit 0, or 2 if there is no such code.

    \b
    Examples:
      sketchlang explain
      sketchlang explain uncovered
    """
    known = pages()
    if code is None:
        width = max(map(len, known))
        for page in known.values():
            say(f"{page.code:{width}}  {page.severity:7}  {page.summary}")
        return
    found = known.get(code.strip("[]"))
    if found is None:
        hint = did_you_mean(code, known)
        say(f"error: there is no diagnostic `{code}`", err=True)
        say(hint or "`sketchlang explain` lists all of them.", err=True)
        raise SystemExit(2)
    click.echo(text(found))


def text(page: Page) -> str:
    """A page for the terminal: fenced blocks become indented ones."""
    lines = [f"{page.severity}[{page.code}]", "", page.summary, ""]
    fenced = False
    for line in page.body.splitlines():
        if line.startswith("```"):
            fenced = not fenced
            if fenced and line == "```output":
                lines.append("")
        else:
            lines.append(f"    {line}".rstrip() if fenced else line)
    return "\n".join(lines)
