"""`sketchlang repair`: the smallest changes after which a sketch terminates."""

from __future__ import annotations

import difflib
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sketchlang.cli import names
from sketchlang.cli.common import Number, domain_option, fail, interruptible, load_valid, say
from sketchlang.errors import InputError
from sketchlang.loader import Loaded, domains_of_file, load_text
from sketchlang.source import Source
from sketchlang.version import __version__

if TYPE_CHECKING:
    from sketchlang.analysis.repair import Proposal


@dataclass(frozen=True)
class Offer:
    """A proposal as it stands in the text: `texts` are the sources with it, by their names."""

    proposal: Proposal
    words: tuple[str, ...]
    texts: dict[str, tuple[Source, str]]

    def diff(self) -> str:
        """The changed lines, as `diff -u` shows them."""
        parts: list[str] = []
        for name, (source, text) in sorted(self.texts.items()):
            old, new = source.text.splitlines(), text.splitlines()
            parts += difflib.unified_diff(old, new, name, f"{name} (repaired)", lineterm="", n=1)
        return "\n".join(parts)


@click.command("repair")
@click.argument("file", metavar="FILE", shell_complete=names.sketches)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option(
    "--count", type=click.IntRange(1, 20), default=3, show_default=True, help="Proposals to make."
)
@click.option("--apply", "chosen", type=click.IntRange(1, 20), metavar="N", help="Make proposal N.")
@click.option(
    "--time-limit",
    type=Number(min=0, max=1e6),
    default=10.0,
    show_default=True,
    metavar="S",
    help="Look for S seconds.",
)
@domain_option
@interruptible
def command(
    *,
    file: str,
    as_json: bool,
    count: int,
    chosen: int | None,
    time_limit: float,
    domain_file: str | None,
) -> None:
    """Find the smallest changes after which a sketch terminates.

    A change tightens an effect, adds a condition, declares a nat bounded, or an invariant; to
    leave out a rule counts as three. Each proposal is proved. Of proposals of one size those
    come first that forbid less of the steps that the sketch allows now. --apply writes
    one of them into FILE.

    Exit 0 if there are proposals, or if the sketch terminates as it is; 1 if none was found;
    2 if the file cannot be read or has errors.

    \b
    Examples:
      sketchlang repair my.sketch
      sketchlang repair my.sketch --apply 1
    """
    loaded = load_valid(file, domain_file)
    from sketchlang.analysis.limits import Budget
    from sketchlang.analysis.repair import find_repairs
    from sketchlang.analysis.termination import Terminating, Undecided, decide_termination

    model = loaded.checked.model
    started = time.perf_counter()
    budget = Budget(time_limit)
    verdict = decide_termination(model, budget)
    fine = isinstance(verdict, Terminating)
    wanted = max(count, chosen or 0)
    found = None if fine else find_repairs(model, budget, wanted)
    proposals = () if found is None else found.proposals
    offers = _offers(loaded, proposals, domain_file)[:wanted]
    if chosen is not None and not fine:
        if chosen > len(offers):
            fail(f"there is no proposal {chosen}", f"{len(offers)} were found")
        _write(loaded, file, offers[chosen - 1])
    shown = offers[:count] if chosen is None else [offers[chosen - 1]] if not fine else []
    undecided = isinstance(verdict, Undecided) and not offers
    if as_json:
        from sketchlang.escape import dumps

        result = _as_json(
            loaded, shown, None if undecided else fine, found is None or found.complete
        )
        seconds = round(time.perf_counter() - started, 6)
        result |= {"applied": chosen if not fine else None, "time_s": seconds}
        click.echo(dumps(result | {"version": __version__}, indent=2))
    elif isinstance(verdict, Undecided) and undecided:
        say(f"{model.name}: undecided, the {verdict.limit} was reached; no repair was found.")
    else:
        _print(model.name, shown, fine, chosen, time_limit)
    sys.exit(0 if fine or offers else 1)


def _offers(loaded: Loaded, proposals: Sequence[Proposal], domain_file: str | None) -> list[Offer]:
    """The proposals whose text is accepted, and proved as it is then read."""
    from sketchlang.analysis.changes import as_words
    from sketchlang.analysis.rewriting import applied, edits
    from sketchlang.analysis.termination import Terminating, decide_termination

    model = loaded.checked.model
    extra = domains_of_file(domain_file) if domain_file is not None else {}
    offers = []
    for proposal in proposals:
        texts = dict(applied(edits(loaded.tree, model, proposal.changes)))
        if set(texts) == {loaded.source.name}:
            source, text = texts[loaded.source.name]
            again = load_text(Source(source.name, text), extra)
            if not again.ok or not isinstance(decide_termination(again.checked.model), Terminating):
                continue
        words = tuple(as_words(model, change) for change in proposal.changes)
        offers.append(Offer(proposal, words, texts))
    return offers


def _write(loaded: Loaded, file: str, offer: Offer) -> None:
    from sketchlang.files import write_bytes

    if set(offer.texts) != {loaded.source.name}:
        fail("the change is in a file that this one includes", "make it there")
    if file == "-" or not Path(file).is_file():
        fail(f"{file}: --apply needs a file of yours")
    try:
        # As bytes: line breaks stay what they are.
        text = offer.texts[loaded.source.name][1]
        write_bytes(Path(file), text.encode(), over_input=True)
    except InputError as error:
        fail(error)


def _print(
    name: str, offers: Sequence[Offer], fine: bool, chosen: int | None, limit: float
) -> None:
    from sketchlang.render import console

    if fine:
        say(f"{name} terminates as it is.")
        return
    if not offers:
        say(f"{name} does not terminate, and no repair was found within {limit:g} s.")
        return
    if chosen is not None:
        say(f"{name}: proposal {chosen} was written. It terminates now.")
    else:
        say(f"{name} does not terminate. After each of these changes it does, as is proved:")
    for number, offer in enumerate(offers, start=1):
        head = f"{number}. " if chosen is None else ""
        smallest = "" if offer.proposal.smallest else ", not the smallest that there is"
        say("", f"{head}{'; '.join(offer.words)} ({_part(offer)}{smallest})")
        console.write(offer.diff() + "\n")


def _part(offer: Offer) -> str:
    part = float(offer.proposal.forbids)
    if not part:
        return "forbids no step that the sketch allows now"
    return f"forbids {max(part, 0.001):.1%} of the steps that the sketch allows now"


def _as_json(
    loaded: Loaded, offers: Sequence[Offer], fine: bool | None, complete: bool
) -> dict[str, Any]:
    return {
        "sketch": loaded.checked.model.name,
        "terminates": fine,
        "complete": complete,
        "proposals": [
            {
                "changes": list(offer.words),
                "forbids": float(offer.proposal.forbids),
                "smallest": offer.proposal.smallest,
                "diff": offer.diff(),
            }
            for offer in offers
        ],
    }
