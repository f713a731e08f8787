"""The last resort: whatever comes out of a command becomes one line and an exit status.

Exit status 1 is a verdict (not terminating, not solved, not valid), and Python's own status for a
traceback is 1 as well: so nothing may leave this way but what commands decide.
"""

from __future__ import annotations

import atexit
import gc
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NoReturn

import click

from sketchlang.errors import InputError
from sketchlang.escape import shown_line, shown_lines

USAGE = 2
"""Bad input, or output that cannot be written."""

BUG = 70
"""What is wrong is in the program (EX_SOFTWARE of sysexits.h)."""

INTERRUPTED = 130
"""After Ctrl-C, as shells have it."""

PIPE_CLOSED = 141
"""Whoever read the output has gone, as shells have it for SIGPIPE: `sketchlang ... | head`."""

TERMINATED = 143
"""After SIGTERM, as shells have it."""

TRACEBACK = "SKETCHLANG_TRACEBACK"
"""Environment variable that asks for the whole traceback of a bug."""


YOUNG = 50_000
"""Objects that are made before the garbage collector looks at them: Python's 700 make it go through
the same imported modules again and again, a tenth of a second at every start."""


def prepare_process() -> None:
    """Make standard streams and signals of this process such that nothing surprising happens.

    Ends the process where standard output is closed.
    """
    gc.set_threshold(YOUNG, *gc.get_threshold()[1:])
    closed = [number for number in range(3) if _is_closed(number)]
    for number in closed:
        # Else the next file that is opened would get the number, and what is printed.
        os.dup2(os.open(os.devnull, os.O_RDWR), number)
    if 1 in closed:
        say_error("error: standard output is closed")
        sys.exit(USAGE)
    for stream in (sys.stdout, sys.stderr):
        # Names of files need not be in the encoding of the terminal, or in any.
        with suppress(AttributeError, ValueError):
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    with suppress(ValueError):  # not the main thread
        # As an exception: what is half written is removed, and other processes are ended.
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(TERMINATED))


def end_process(status: int) -> NoReturn:
    """End the process, without taking apart what the system frees at once.

    Freeing compiled code and libraries object by object takes a fifth of a second. What has asked
    to be called at the end is called; other threads are waited for as ever.
    """
    if threading.active_count() == 1:
        atexit._run_exitfuncs()
        with suppress(OSError, ValueError):
            flush()
        os._exit(status)
    sys.exit(status)


def status_of(work: Callable[[], object]) -> int:
    """Do the work of a command; the exit status, with what went wrong said in one line."""
    try:
        status = _status(work)
        flush()
    except BaseException as error:
        status = _tell(error)
        with suppress(BaseException):
            flush()
    return status


def flush() -> None:
    """What is printed goes out now: a full disk has to show, not be lost when Python exits."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()


def _status(work: Callable[[], object]) -> int:
    try:
        work()
    except click.exceptions.Exit as error:
        return error.exit_code
    except SystemExit as error:
        if error.code is None or isinstance(error.code, int):
            return error.code or 0
        raise click.ClickException(str(error.code)) from None
    return 0


def _tell(error: BaseException) -> int:
    """Say what happened, in one line if that is possible, and return the status for it."""
    match error:
        case KeyboardInterrupt() | click.Abort() | EOFError():
            say_error("interrupted")
            return INTERRUPTED
        case BrokenPipeError():
            _drop_output()
            return PIPE_CLOSED
        case click.ClickException():
            _tell_usage(error)
        case InputError():
            say_error(f"error: {error}")
        case OSError():
            _drop_output()
            say_error(f"error: {_words(error)}")
        case MemoryError():
            say_error("error: out of memory")
        case RecursionError():
            say_error("error: the input is nested too deeply")
        case _:
            say_error(_bug(error))
            return BUG
    return USAGE


def _tell_usage(error: click.ClickException) -> None:
    context = getattr(error, "ctx", None)
    if context is not None:
        say_error(context.get_usage())
        if context.command.get_help_option(context) is not None:
            name = context.help_option_names[-1]
            say_error(f"Try '{context.command_path} {name}' for help.\n")
    say_error(f"Error: {shown_line(error.format_message())}")


def _words(error: OSError) -> str:
    reason = error.strerror or str(error)
    if error.filename is not None:
        return shown_line(f"{os.fsdecode(error.filename)}: {reason}")
    # Commands tell of their files themselves. What is left is standard output.
    return f"output cannot be written: {reason}"


def _bug(error: BaseException) -> str:
    if os.environ.get(TRACEBACK):
        return "".join(traceback.format_exception(error))
    place = traceback.extract_tb(error.__traceback__)[-1:]
    where = f" ({os.path.basename(place[0].filename)}:{place[0].lineno})" if place else ""
    text = shown_line(f"{type(error).__name__}: {error}")
    return f"error: a bug in sketchlang{where}: {text}; {TRACEBACK}=1 shows more"


def say_error(text: str) -> None:
    """Print to standard error; where that is not possible, there is nobody to tell."""
    with suppress(OSError, ValueError):
        click.echo(shown_lines(text), err=True)


def _drop_output() -> None:
    """What is still buffered cannot be written either: it goes nowhere."""
    with suppress(OSError, ValueError, AttributeError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def _is_closed(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return True
    return False


def run_group(group: click.Group, arguments: list[str], name: str, **extra: Any) -> int:
    """Run a group of commands with some arguments; the exit status."""

    def work() -> None:
        with group.make_context(name, arguments, **extra) as context:
            group.invoke(context)

    return status_of(work)
