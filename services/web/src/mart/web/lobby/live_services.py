"""Which services are alive, by what the bus tells of their liveliness tokens. Pure."""

from __future__ import annotations

from collections.abc import Iterable

from mart.protocol.vocabulary import ServiceKind


class LiveServices:
    """The services that are alive, by kind.

    The bus tells of every token that comes or goes. Where such a word was lost, `compare` with a list of all tokens
    finds it: whoever counts on being told must also be able to ask.
    """

    def __init__(self) -> None:
        self._alive: set[str] = set()
        self._doubted: set[str] = set()
        self._seen: set[str] = set()  # kinds

    def tell(self, key: str, alive: bool) -> None:
        """Take in that the service of the liveliness key `key` came or went."""
        (self._alive.add if alive else self._alive.discard)(key)
        self._doubted.discard(key)
        self._seen.add(service_of(key)[0])

    def compare(self, keys: Iterable[str]) -> dict[str, bool]:
        """Return what was never told: each liveliness key that came (True) or went (False), as `keys` has it.

        `keys` are all that exist. A list may be older than the newest word, so only a difference that two lists in a
        row show, with no word in between, is one.
        """
        listed = set(keys)
        differing = self._alive ^ listed
        missed = differing & self._doubted
        self._doubted = differing - missed
        return {key: key in listed for key in sorted(missed)}

    def ids(self, kind: ServiceKind) -> list[str]:
        """Return the ids of the services of `kind` that are alive, sorted."""
        return self.by_kind().get(kind, [])

    def were_seen(self, kind: ServiceKind) -> bool:
        """Return whether a service of `kind` was ever alive."""
        return kind in self._seen

    def by_kind(self) -> dict[str, list[str]]:
        """Return the sorted ids of the services that are alive under each kind that has any."""
        found: dict[str, list[str]] = {}
        for key in sorted(self._alive):
            kind, service = service_of(key)
            found.setdefault(kind, []).append(service)
        return found


def service_of(alive_key: str) -> tuple[str, str]:
    """Return the kind and the id of the service that holds the liveliness key `alive_key`."""
    kind, id_ = alive_key.split("/")[-2:]
    return kind, id_
