"""`sketchlang lsp`: the language server."""

from __future__ import annotations

import importlib.util

import click

from sketchlang.cli.common import domain_option, fail


@click.command("lsp")
@domain_option
def command(domain_file: str | None) -> None:
    """Serve an editor on standard input and output (language server protocol).

    Editors start it by themselves; docs/editors.md says how. Exit 0 when the editor leaves, 2 if
    pygls is not installed.

    \b
    Examples:
      sketchlang lsp
      sketchlang lsp --domain my_domain.py
    """
    if importlib.util.find_spec("pygls") is None:
        fail("the language server needs pygls: pip install 'sketchlang[lsp]'")
    from sketchlang.lsp.server import serve

    serve(domain_file)
