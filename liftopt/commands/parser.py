"""A parser of the command line whose complaints are one line that says what may have been meant."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.scenario.file import shipped_scenarios
from liftopt.scenario.keys import refuse_contradictions
from liftopt.scenario.listing import DEFAULT_TEAM, describe
from liftopt.scenario.meant import nearest_keys
from liftopt.scenario.model import Scenario
from liftopt.storage.result_folder import holds_result

SET = "--set"
DASHES = "-\u2013\u2014"  # word processors make dashes of two hyphens
LIKE_AN_OPTION = re.compile(rf"(--|[{DASHES}](?=\S\S))[^\W\d][\w.-]*")


class Parser(argparse.ArgumentParser):
    """An ``ArgumentParser`` that raises ``InputError``; its subparsers are of its kind.

    argparse takes the words it understands first and complains of the rest; what is wrong is often seen better in the
    words as they stand, so they are looked at before.
    """

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Return the namespace, and no words that are left.

        Raises:
            InputError: the words are wrong.
            SystemExit: with status 0 after ``--help`` and ``--version``.
        """
        words: list[str] = list(sys.argv[1:] if args is None else args)
        commands = next((a.choices for a in self._actions if isinstance(a, argparse._SubParsersAction)), None)
        mine = list(_until_command(words)) if commands is not None else words
        self._check_options(mine, commands is not None)
        if commands is not None:
            self._check_command(words[len(mine) :], list(commands))
        elif SET in self._option_string_actions:
            self._check_overrides(words)
        namespace, left = super().parse_known_args(words, namespace)
        if left:
            odd = left[0].startswith("-")
            self.error(f"there is no option {left[0]}" if odd else f"{left[0]!r} is too much")
        refuse_contradictions(getattr(namespace, "overrides", ()))
        return namespace, left

    def error(self, message: str) -> NoReturn:
        """Raise ``InputError`` with what argparse has to say."""
        command = self.prog.partition(" ")[2] or "command line"
        raise InputError(command, NO_VALUE, f"{message} ({self.prog} --help says more)")

    def _check_options(self, words: Sequence[str], before_command: bool) -> None:
        """Raise ``InputError`` for the first option that is not known."""
        for word in words:
            name = word.partition("=")[0]
            if word == "--":
                return
            if not LIKE_AN_OPTION.fullmatch(name) or name in self._option_string_actions:
                continue
            name = "--" + name.lstrip(DASHES)
            if before_command:
                self.error(f"there is no option {name} here; options stand after the command")
            options = nearest(name, [known for known in self._option_string_actions if known.startswith("--")])
            keys = nearest_keys(name[2:], [key for key, _ in describe(Scenario, DEFAULT_TEAM)], DEFAULT_TEAM)
            if not options and keys and SET in self._option_string_actions:
                value = word.partition("=")[2] or "VALUE"
                self.error(f"there is no option {name}{did_you_mean([f'{SET} {key}={value}' for key in keys])}")
            self.error(f"there is no option {word.partition('=')[0]}{did_you_mean(options)}")

    def _check_command(self, words: Sequence[str], commands: Sequence[str]) -> None:
        if not words:
            return  # --help, or argparse says that it is missing
        word = words[0]
        if word in commands:
            return
        if word in shipped_scenarios() or word.endswith(".toml"):
            self.error(f"{word!r} is no command; did you mean {self.prog} solve {word}?")
        if holds_result(Path(word)):
            self.error(f"{word!r} is no command; did you mean {self.prog} view {word}?")
        if word in ("help", "version"):
            self.error(f"{word!r} is no command; did you mean {self.prog} --{word}?")
        meant = nearest(word, commands)
        self.error(f"{word!r} is no command" + (did_you_mean(meant) or "; there are " + ", ".join(commands)))

    def _check_overrides(self, words: Sequence[str]) -> None:
        """Raise ``InputError`` where the value of a ``--set`` stands apart from its key."""
        for i, word in enumerate(words):
            if word == SET:
                given, rest = words[i + 1 : i + 2], words[i + 2 :]
            elif word.startswith(SET + "="):
                given, rest = [word.partition("=")[2]], words[i + 1 :]
            else:
                continue
            apart = list(_until_option(rest))
            if not given or given[0].startswith("--") or not apart:
                continue  # nothing that could be put together
            key, equals, value = given[0].partition("=")
            if value.strip() or (not equals and (apart[0] in shipped_scenarios() or Path(apart[0]).exists())):
                continue
            value = "".join(apart[:2] if apart[0] == "=" else apart[:1]).lstrip("=").rstrip(",")
            if not value:
                continue
            told = " ".join((given[0], *(apart[:2] if apart[0] == "=" else apart[:1])))
            raise InputError(
                f"{SET} {told}", NO_VALUE, f"must be KEY=VALUE without spaces; write {SET} {key.strip()}={value}"
            )


def _until_command(words: Sequence[str]) -> Iterator[str]:
    for word in words:
        if not word.startswith("-"):
            return
        yield word


def _until_option(words: Sequence[str]) -> Iterator[str]:
    for word in words:
        if word.startswith("--"):
            return
        yield word
