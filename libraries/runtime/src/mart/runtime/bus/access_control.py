"""Turn `mart.protocol.rights` into Zenoh's access control: who has which certificate may do what, all else is denied.

Tried with Zenoh 1.10.2. A router filters what comes in from a part (ingress) and what goes out to it (egress), and both
need rules: a publisher that is not told of subscribers sends nothing, a querier that is not told of services asks
nobody. What an advanced publisher keeps for those who missed it is asked for below `@adv` of its key, and replied under
the key itself. Of a session's own messages to itself the router knows nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from mart.protocol import keys
from mart.protocol.rights import RIGHTS, BusPart, Rights

Rule = dict[str, Any]


def access_control(names: Mapping[BusPart, Sequence[str]]) -> dict[str, Any]:
    """Return Zenoh's `access_control`.

    names: the common names of the certificates that each part may show; a part without one is denied everything.
    """
    rules: list[Rule] = []
    policies: list[Rule] = []
    named = {part: list(common_names) for part, common_names in names.items() if common_names}
    for part in named:
        own = _rules(part.value, RIGHTS[part])
        rules += own
        policies.append({"rules": [rule["id"] for rule in own], "subjects": [part.value]})
    subjects = [{"id": part.value, "cert_common_names": given} for part, given in named.items()]
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def _rules(part: str, rights: Rights) -> list[Rule]:
    announced = [keys.alive_of(kind) for kind in rights.announces]
    asked = [*rights.asks, keys.admission().key]
    said, heard = list(rights.says), list(rights.hears)
    said_before, heard_before = ([f"{key}/@adv/**" for key in named] for named in (said, heard))
    found = [
        _rule("in", said, "put", "delete", "reply"),
        _rule("out", said, "declare_subscriber"),
        _rule("in", said_before, "put", "declare_queryable", "reply", "liveliness_token"),
        _rule("out", said_before, "declare_subscriber", "query"),
        _rule("in", heard, "declare_subscriber"),
        _rule("out", heard, "put", "delete", "reply"),
        _rule("in", heard_before, "declare_subscriber", "query", *_WATCH),
        _rule("out", heard_before, "put", "declare_queryable", "reply", "liveliness_token"),
        _rule("in", list(rights.serves), "declare_queryable", "reply"),
        _rule("out", list(rights.serves), "query"),
        _rule("in", asked, "query"),
        _rule("out", asked, "declare_queryable", "reply"),
        _rule("in", announced, "liveliness_token"),
        _rule("in", [keys.EVERY_ALIVE], *_WATCH),
        _rule("out", [keys.EVERY_ALIVE], "liveliness_token", "reply"),
    ]
    needed = [rule for rule in found if rule["key_exprs"]]
    return [{"id": f"{part}-{number}", **rule} for number, rule in enumerate(needed)]


_WATCH = ("liveliness_query", "declare_liveliness_subscriber")


def _rule(way: str, key_expressions: list[str], *messages: str) -> Rule:
    flow = {"in": "ingress", "out": "egress"}[way]
    return {
        "permission": "allow",
        "flows": [flow],
        "messages": list(messages),
        "key_exprs": key_expressions,
    }
